// What a study has found so far: its cases, what each of them was given, and what it came to.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kluft {

/// Where a case stands. The first two have no results yet.
enum class CaseStatus {
    waiting,
    running,
    done,           ///< the run ended by itself with exit code 0 (also `collapsed`)
    no_equilibrium, ///< exit code 3; what came out until then is there
    refused,        ///< exit code 2: the scene and the settings do not go together
    failed          ///< killed, out of resources, out of time or crashed; `reason` says which
};

struct StudyCase {
    std::string name;                  ///< of its directory below cases/, made of its settings: "event,steps=25,r0"
    std::string variant;               ///< name of its group of settings; empty without variants
    std::vector<std::string> settings; ///< per parameter of the table, as YAML text
    int replica = 0;                   ///< from 0; cases that differ in nothing else are copies
    CaseStatus status = CaseStatus::waiting;
    std::string reason;                            ///< why it did not end as done; empty otherwise
    bool out_of_resources = false;                 ///< whether it failed for lack of disk or memory
    std::vector<std::optional<double>> quantities; ///< per quantity of the table
    std::vector<std::optional<double>> errors;     ///< the same against the reference, relative; with sign
    std::optional<double> curve_error; ///< L2 distance of the curve to that of the reference, relative to its L2 norm
    std::optional<double> cpu_s;       ///< CPU time of the case (s)
    std::optional<double> elapsed_s;   ///< wall-clock time (s)
};

struct StudyTable {
    std::string title;
    std::filesystem::path directory;       ///< of the study; results of a case stand in directory/cases/<name>
    std::vector<std::string> parameters;   ///< key paths that vary
    std::vector<std::string> own_settings; ///< per parameter what the scene itself says; empty where that is not known
    std::vector<std::string> quantities;   ///< names of numbers in summary.json
    std::optional<std::size_t> along;      ///< parameter that plots and extrapolation run along, with numeric values
    std::optional<std::size_t> reference;  ///< case that the others are compared with, if it is one of them
    std::string reference_name;            ///< in words: "case 0007 (stages.1.steps: 800)", "closed form", a directory
    std::vector<StudyCase> cases;
};

} // namespace kluft
