#include "kluft/studies/study_emit.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/core/shell_line.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/studies/study_results.hpp"
#include "kluft/studies/study_run.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

const std::vector<std::string> formats{"slurm", "make"};

std::size_t n_lines(const ReadStudy& read) {
    return std::ranges::count_if(read.cases, [](const PlannedCase& one) { return one.refusal.empty(); });
}

/// For make: a dollar begins a variable, an equals sign an assignment.
std::string make_text(const std::string& text, bool target) {
    std::string result;
    for (const char c : text) {
        if (c == '$')
            result += "$$";
        else if (target && c == '=')
            result += "$(eq)";
        else
            result += c;
    }
    return result;
}

/// For Slurm's patterns of file names: a per cent sign begins a symbol.
std::string pattern_text(const std::string& path) {
    std::string result;
    for (const char c : path) result += c == '%' ? std::string("%%") : std::string(1, c);
    return result;
}

/// "#SBATCH --time" from the limit of a case: twice that, for the start and for saving; "" without a limit.
std::string time_option(const Study& study) {
    if (study.time_limit <= 0.0) return {};
    constexpr double seconds_per_minute = 60.0, spare_minutes = 5.0;
    return fmt::format("#SBATCH --time={:.0f}\n", std::ceil(study.time_limit / seconds_per_minute) + spare_minutes);
}

} // namespace

std::vector<std::string> emitted_files(const std::string& format) {
    return {"run-case", format == "make" ? "Makefile" : "study.slurm"};
}

std::string case_script() {
    return R"script(#!/bin/bash
# run-case N: runs line N (from 0) of cases.txt, from its saved state where there is one. Signals make it save its
# state; in a Slurm job that comes to its time limit it asks for another turn.
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
line=$(sed -n "$(($1 + 1))p" "$here/cases.txt")
if [[ -z $line ]]; then
    echo "run-case: no line $1 in $here/cases.txt" >&2
    exit 2
fi
eval "words=($line)"
for ((i = 0; i < ${#words[@]}; ++i)); do
    if [[ ${words[i]} == -o ]]; then directory=${words[i + 1]}; fi
done
is_ended() { grep -qs -e '"exit_code": *[023][,}]' "$directory/outcome.json"; }
if is_ended; then
    touch "$directory/ended"
    exit 0
fi
mkdir -p "$directory"
if command -v flock >/dev/null && [[ -e $directory/.lock ]] && ! flock -n -s "$directory/.lock" true; then
    echo "run-case: $directory: expected no other process that runs this case, found one" >&2
    exit 1
fi

child=
turn_wanted=false
stop() { if [[ -n $child ]]; then kill -INT "$child" 2>/dev/null; fi; }
trap 'turn_wanted=true; stop' USR1
trap stop INT TERM

run() {
    "$@" 2>"$directory/messages.txt" &
    child=$!
    wait "$child"
    code=$?
    while kill -0 "$child" 2>/dev/null; do # a signal ended the wait
        wait "$child"
        code=$?
    done
    child=
}

if [[ -e $directory/state.h5 ]]; then
    run "${words[@]}" --resume
    if [[ $code == 2 ]]; then run "${words[@]}" --force; fi # a state that cannot be gone on from
else
    run "${words[@]}" --force # the directory is the study's
fi
stopped=false # by a signal that makes it save its state: HUP, INT, QUIT, USR1, USR2, ALRM, TERM, XCPU
case $code in 129 | 130 | 131 | 138 | 140 | 142 | 143 | 152) stopped=true ;; esac
if ((code > 128)) && ! $stopped; then
    outcome="{\"exit_code\": -1, \"signal\": $((code - 128))}"
else
    outcome="{\"exit_code\": $code}"
fi
echo "$outcome" >"$directory/outcome.json.part" && mv "$directory/outcome.json.part" "$directory/outcome.json"
if is_ended; then
    touch "$directory/ended"
    exit 0
fi
if $turn_wanted && $stopped && [[ -n $SLURM_JOB_ID ]]; then scontrol requeue "$SLURM_JOB_ID"; fi
cat "$directory/messages.txt" >&2
exit 1
)script";
}

std::string slurm_script(const ReadStudy& read, const fs::path& directory, int jobs) {
    return fmt::format(R"(#!/bin/bash
#SBATCH {}
#SBATCH --array=0-{}%{}
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=1
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@120
#SBATCH {}
{}# Two minutes before its time limit a job saves its state and asks for another turn; requeued, it goes on from there.
exec bash {} "$SLURM_ARRAY_TASK_ID"
)",
                       shell_line({"--job-name=kluft-" + read.study.name}), n_lines(read) - 1, jobs,
                       shell_line({"--output=" + pattern_text(directory.string()) + "/slurm-%a.log"}),
                       time_option(read.study), shell_line({directory / "run-case"}));
}

std::string study_makefile(const ReadStudy& read, const std::vector<std::string>& collect) {
    std::string targets, rules;
    std::size_t line = 0;
    for (const auto& one : read.cases) {
        if (!one.refusal.empty()) continue;
        const std::string target = make_text("cases/" + one.name + "/ended", true);
        targets += " \\\n    " + target;
        rules += fmt::format("{}:\n\t-@bash run-case {}\n", target, line++);
    }
    return fmt::format("# Runs the cases of a study that have not ended yet, then gathers the table.\n"
                       "eq := =\n\n.PHONY: collect\ncollect:{}\n\t{}\n\n{}",
                       targets, make_text(shell_line(collect), false), rules);
}

std::string emit_study(const std::string& format, const ReadStudy& read, const fs::path& directory, int jobs,
                       const std::vector<std::string>& collect) {
    if (std::ranges::find(formats, format) == formats.end())
        throw InputError(fmt::format("--emit: expected one of {}, found '{}'{}", listed(formats), format,
                                     suggestion(format, formats)));
    for (const auto& word : collect) require_one_line("kluft study --emit", word);
    write_file(directory / "run-case", case_script());
    if (format == "make") {
        write_file(directory / "Makefile", study_makefile(read, collect));
        return shell_line({"make", fmt::format("-j{}", jobs), "-C", directory}) + '\n';
    }
    write_file(directory / "study.slurm", slurm_script(read, directory, jobs));
    return shell_line({"sbatch", "--wait", directory / "study.slurm"}) + '\n' + shell_line(collect) + '\n';
}

} // namespace kluft
