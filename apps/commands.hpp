// The subcommands and what the command line tells them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kluft {

enum class ExitCode {
    done = 0,
    missed = 1, ///< a comparison, a validation case or a target missed its tolerance, a case of a study failed
    bad_input = 2,
    no_equilibrium = 3,
    out_of_resources = 4 ///< 128 and more: exit_code_of_stop
};

/// The name of a run: that of its directory, also of "." and "results/case-3/".
[[nodiscard]] std::string run_name(const std::filesystem::path& directory);
/// Names of several runs, or the directories where two runs have the same name.
[[nodiscard]] std::vector<std::string> run_names(const std::vector<std::string>& directories);

struct RunArguments {
    std::string scene;
    std::string directory;
    std::vector<std::string> overrides;
    int threads = 0;
    bool quiet = false;
    bool resume = false;
    bool force = false; ///< replaces results of another scene
};

[[nodiscard]] ExitCode run(const RunArguments& arguments);

struct CheckArguments {
    std::string scene;
    std::vector<std::string> overrides;
    bool json = false;
};

[[nodiscard]] ExitCode check(const CheckArguments& arguments);

/// Says the JSON Schema of a kind of file: scene, study or calibration.
[[nodiscard]] ExitCode schema(const std::string& of);

struct DrawArguments {
    std::vector<std::string> sources;
    std::string picture;
    std::string title;
    std::vector<std::string> marks;
    std::string limit;
    std::vector<std::string> overrides;
    bool curve = false;
    bool blocks = false;
    bool histories = false;
    std::string step;   ///< of the kept state that is drawn: a load step, peak or last; empty: the last saved state
    std::string field;  ///< that blocks are coloured by
    std::string scale;  ///< of displacements
    std::string window; ///< x0,y0,x1,y1
    [[nodiscard]] bool is_of_state() const {
        return !step.empty() || !field.empty() || !scale.empty() || !window.empty();
    }
};

[[nodiscard]] ExitCode draw(const DrawArguments& arguments);

struct ReportArguments {
    std::vector<std::string> directories;
    std::string output; ///< .html, of a single directory; empty: report.html in each
};

/// Writes the pages of runs.
[[nodiscard]] ExitCode report(const ReportArguments& arguments);

struct ExportArguments {
    std::string directory;
    std::string output; ///< .gpkg or .geojson; empty: <run name>.gpkg
    std::string step;   ///< of the kept state: a load step, peak or last; empty: last
};

[[nodiscard]] ExitCode export_map(const ExportArguments& arguments);

struct CompareArguments {
    std::vector<std::string> directories; ///< two
    std::string tolerance = "0.05";
    std::string output;
};

[[nodiscard]] ExitCode compare(const CompareArguments& arguments);

struct EnvelopeArguments {
    std::vector<std::string> sources; ///< directories of results and tables (.csv)
    std::vector<std::string> tension; ///< tensile strengths found elsewhere
    std::string picture = "envelope.png";
    std::string title = "Strength envelope";
    std::vector<std::string> others;
};

[[nodiscard]] ExitCode envelope(const EnvelopeArguments& arguments);

struct StudyArguments {
    std::vector<std::string> words; ///< a study file, or the name of a ready-made study and a scene
    std::string directory;
    std::vector<std::string> overrides;
    int jobs = 0; ///< 0: as many as there are processors
    std::string emit;
    std::string quantity; ///< that is recommended for; empty: the first of the study
    bool collect = false;
    bool force = false; ///< replace results of a study of another scene
    bool quiet = false;
};

[[nodiscard]] ExitCode study(const StudyArguments& arguments);

struct CalibrateArguments {
    std::string target; ///< calibration file
    std::string directory;
    int jobs = 0; ///< 0: as many as there are processors
    bool quiet = false;
};

/// Becomes kluft-calibrate, whose exit code is that of the program; returns only by an InputError.
[[nodiscard]] ExitCode calibrate(const CalibrateArguments& arguments);

struct ValidateArguments {
    std::vector<std::string> words; ///< for scripts/validate
};

/// Names of the cases of the validation suite; none where there is no suite.
[[nodiscard]] std::vector<std::string> validation_cases();

/// Becomes scripts/validate, whose exit code is that of the program; returns only by an InputError.
[[nodiscard]] ExitCode validate(const ValidateArguments& arguments);

} // namespace kluft
