// The program as a user sees it: what it prints, the files it leaves, its exit codes.
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/wait.h>
#include <unistd.h>

#include "kluft/maps/gdal.hpp"
#include "kluft/output/state_file.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;
using testing::TemporaryDirectory;
using Words = std::vector<std::string>;

std::string content_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    EXPECT_TRUE(file) << path;
    return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

enum class Reader {
    file,    ///< what the program says is kept
    nobody,  ///< standard output and error lead into a pipe that nobody reads
    no_room, ///< standard output leads to a full device
    closed   ///< there is neither
};

/// What a child process may use, where 0 is no limit, and who reads what it says.
struct Limits {
    rlim_t file_bytes = 0;
    rlim_t memory_bytes = 0;
    std::map<std::string, std::string> environment = {};
    rlim_t stack_bytes = 0; ///< also of each thread
    Reader reader = Reader::file;
};

void limit(int resource, rlim_t most) {
    const rlimit both{most, most};
    if (most != 0) setrlimit(static_cast<__rlimit_resource>(resource), &both);
}

void send_to_file(int descriptor, const fs::path& path) {
    const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (file < 0 || dup2(file, descriptor) < 0) _exit(126);
}

void send_to(Reader reader) {
    int ends[2];
    if (reader == Reader::no_room) send_to_file(STDOUT_FILENO, "/dev/full");
    if (reader == Reader::closed) {
        close(STDOUT_FILENO);
        close(STDERR_FILENO);
    }
    if (reader != Reader::nobody) return;
    if (pipe(ends) != 0 || dup2(ends[1], STDOUT_FILENO) < 0 || dup2(ends[1], STDERR_FILENO) < 0) _exit(126);
    close(ends[0]);
    close(ends[1]);
}

/// The program in a child process, in a working directory of its own.
class Child {
public:
    Child(const fs::path& directory, const Words& words, const Limits& limits = {})
        : out_(directory / ".stdout"), err_(directory / ".stderr") {
        Words all{KLUFT_PROGRAM};
        all.insert(all.end(), words.begin(), words.end());
        std::vector<char*> arguments;
        for (auto& word : all) arguments.push_back(word.data());
        arguments.push_back(nullptr);
        pid_ = fork();
        if (pid_ != 0) return;
        if (chdir(directory.c_str()) != 0) _exit(126);
        send_to_file(STDOUT_FILENO, out_);
        send_to_file(STDERR_FILENO, err_);
        send_to(limits.reader);
        limit(RLIMIT_FSIZE, limits.file_bytes);
        limit(RLIMIT_AS, limits.memory_bytes);
        limit(RLIMIT_STACK, limits.stack_bytes);
        setenv("OPENBLAS_NUM_THREADS", "1", 1);
        for (const auto& [name, value] : limits.environment) setenv(name.c_str(), value.c_str(), 1);
        execv(KLUFT_PROGRAM, arguments.data());
        _exit(126);
    }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
    ~Child() {
        if (pid_ > 0) {
            kill(pid_, SIGKILL);
            waitpid(pid_, nullptr, 0);
        }
    }

    void interrupt() const { send(SIGINT); }
    void send(int signal) const { kill(pid_, signal); }

    /// The exit code; 128 and the signal's number when it died of one.
    int wait() {
        int status = 0;
        while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
        }
        pid_ = 0;
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }

    [[nodiscard]] std::string out() const { return content_of(out_); }
    [[nodiscard]] std::string err() const { return content_of(err_); }

private:
    fs::path out_, err_;
    pid_t pid_ = 0;
};

struct Result {
    int code = 0;
    std::string out, err;
};

class CommandLine : public ::testing::Test {
protected:
    Result kluft(const Words& words, const Limits& limits = {}) const {
        Child child(directory_.path(), words, limits);
        const int code = child.wait();
        return {code, child.out(), child.err()};
    }

    /// One message, exit code 2, nothing on standard output.
    void expect_refused(const Words& words, const ::testing::Matcher<const std::string&>& message) const {
        const Result result = kluft(words);
        EXPECT_EQ(result.code, 2) << result.err;
        EXPECT_THAT(result.err, message);
        EXPECT_THAT(result.out, IsEmpty());
    }

    fs::path path(const std::string& name) const { return directory_ / name; }
    void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
    nlohmann::json summary(const std::string& run) const {
        return nlohmann::json::parse(content_of(path(run) / "summary.json"));
    }

    /// Waits until the history of a run has a number of lines.
    void wait_for_rows(const std::string& run, std::size_t n) const {
        const fs::path history = path(run) / "history.csv";
        for (int i = 0; i < 3000 && !(fs::exists(history) && lines_of(content_of(history)).size() >= n); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }

    /// A table without its column of times, the last one.
    std::string table(const std::string& file) const {
        std::string text;
        for (const auto& line : lines_of(content_of(path(file)))) text += line.substr(0, line.rfind(',')) + '\n';
        return text;
    }

    /// Name and content of all files below a directory.
    std::map<std::string, std::string> files_in(const std::string& directory) const {
        std::map<std::string, std::string> files;
        for (const auto& entry : fs::recursive_directory_iterator(path(directory)))
            if (entry.is_regular_file())
                files[entry.path().lexically_relative(path(directory)).string()] = content_of(entry.path());
        return files;
    }

    TemporaryDirectory directory_;
};
using SlowCommandLine = CommandLine;

std::string model(const std::string& name) { return std::string(KLUFT_MODELS_DIR) + "/" + name; }

// Six blocks, two stages, cracks: runs in a tenth of a second.
const char* const tiny_scene = R"(kluft: 1
title: Tiny
materials:
  rock: {density: 2300, youngs_modulus: 1500 MPa, poissons_ratio: 0.25, cohesion: 0.05 MPa, friction_angle: 40, tensile_strength: 0.05 MPa}
interfaces:
  joint: {kind: fracture, normal_stiffness_times_spacing: 200 MPa, shear_stiffness_times_spacing: 100 MPa, friction_angle: 20, cohesion: 0.02 MPa}
  bond: {kind: potential_crack, normal_stiffness_times_spacing: 200 MPa, shear_stiffness_times_spacing: 100 MPa, fails_to: joint}
geometry:
  domain: {rectangle: {width: 0.2, height: 0.4}}
  tessellation: {hexagons: {spacing: 0.1}, interface: bond}
boundaries: {bottom: {support: smooth}}
stages:
  - {name: pressure, pressure: {left: 0.1 MPa, right: 0.1 MPa, top: 0.1 MPa}, steps: 2}
  - {name: platen, strain: {boundary: top, value: 1 %}, steps: 8}
)";

// A block pushed sideways over a smooth plane under a platen: nothing stops it.
const char* const sliding_scene = R"(kluft: 1
analysis: {plane: stress}
materials: {rock: {youngs_modulus: 1 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e9, shear_stiffness: 1e9, friction_angle: 0}}
geometry:
  domain: {rectangle: {width: 4.0, height: 1.5}}
  fractures: [{trace: [[-1, 0.5], [5, 0.5]], interface: joint}]
  reference_spacing: 1.0
boundaries: {bottom: {support: fixed}}
stages:
  - {name: squeeze, strain: {boundary: top, value: 1e-5}, steps: 2}
  - {name: push, strain: {boundary: top, value: 1e-5}, pressure: {left: 1 MPa}, steps: 12}
)";

// The same without platen and support.
const char* const loose_scene = R"(kluft: 1
analysis: {plane: stress}
materials: {rock: {youngs_modulus: 1 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e9, shear_stiffness: 1e9, friction_angle: 30}}
geometry:
  domain: {rectangle: {width: 4.0, height: 1.5}}
  fractures: [{trace: [[-1, 0.5], [5, 0.5]], interface: joint}]
  reference_spacing: 1.0
stages: [{name: push, pressure: {left: 1 MPa}, steps: 2}]
)";

bool is_read_only(const char* place) {
    struct statvfs status {};
    return statvfs(place, &status) == 0 && (status.f_flag & ST_RDONLY) != 0;
}

Words with(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

const Words commands{"run",     "check",    "draw",  "report",    "export",
                     "compare", "envelope", "study", "calibrate", "completion"};

// ---- help, version, mistakes ---------------------------------------------------------------------------------------

TEST_F(CommandLine, HelpOfTheProgramNamesEverySubcommandAndGivesExamples) {
    const Result result = kluft({"--help"});
    EXPECT_EQ(result.code, 0);
    EXPECT_THAT(result.err, IsEmpty());
    EXPECT_THAT(result.out, HasSubstr("Examples:"));
    for (const auto& command : commands) EXPECT_THAT(result.out, HasSubstr("\n  " + command + " ")) << command;
}

TEST_F(CommandLine, HelpOfEverySubcommandGivesAnExample) {
    for (const auto& command : commands) {
        const Result result = kluft({command, "--help"});
        EXPECT_EQ(result.code, 0) << command;
        EXPECT_THAT(result.out, ContainsRegex("Examples?:.*\n?.*kluft " + command)) << command;
    }
}

TEST_F(CommandLine, VersionIsThreeNumbersAndTheCommitAndWhetherThereIsGdal) {
    const Result result = kluft({"--version"});
    EXPECT_EQ(result.code, 0);
    EXPECT_TRUE(
        std::regex_match(result.out, std::regex("[0-9]+\\.[0-9]+\\.[0-9]+( \\([0-9a-f]+(-dirty)?\\))?\nwith(out GDAL: "
                                                "maps as GeoJSON in metres| GDAL [0-9.]+)\n")))
        << result.out;
}

TEST_F(CommandLine, MistypedSubcommandIsAnsweredWithTheNearestOne) {
    expect_refused({"chekc", "x.yaml"}, AllOf(HasSubstr("'chekc'"), HasSubstr("did you mean 'check'?")));
    expect_refused({}, HasSubstr("kluft --help"));
}

TEST_F(CommandLine, MistypedOptionIsAnsweredWithTheNearestOne) {
    expect_refused({"run", "x.yaml", "--resum"},
                   AllOf(StartsWith("kluft run: unknown option '--resum'"), HasSubstr("did you mean '--resume'?")));
    expect_refused({"run", "--thread", "2", "x.yaml"}, HasSubstr("did you mean '--threads'?"));
    expect_refused({"draw", "x", "--tilte=a"}, HasSubstr("did you mean '--title'?"));
    expect_refused({"--hepl"}, HasSubstr("did you mean '--help'?"));
}

TEST_F(CommandLine, WordsThatAreMissingOrTooManyAreNamed) {
    expect_refused({"run"}, AllOf(HasSubstr("scene"), HasSubstr("kluft run --help")));
    expect_refused({"check", "a.yaml", "b.yaml"}, HasSubstr("b.yaml"));
    expect_refused({"run", "a.yaml", "--threads", "0"}, HasSubstr("range 1 to "));
}

TEST_F(CommandLine, FileThatIsMissingIsNamed) {
    expect_refused({"run", "absent.yaml"}, HasSubstr("absent.yaml: expected a scene, found no such file"));
    expect_refused({"check", "absent.yaml"}, HasSubstr("absent.yaml"));
    expect_refused({"run", "."}, HasSubstr("found a directory"));
    EXPECT_FALSE(fs::exists(path("results")));
}

TEST_F(CommandLine, NameUnderWhichNothingCanBeIsRefused) {
    write("tiny.yaml", tiny_scene);
    const std::string long_name(300, 'a');
    for (const std::string& name : {long_name, std::string("tiny.yaml/results")}) {
        expect_refused({"run", "tiny.yaml", "-o", name}, HasSubstr(name));
        expect_refused({"draw", "tiny.yaml", "-o", name + ".png"}, HasSubstr(name));
        expect_refused({"study", "step-size", "tiny.yaml", "-o", name}, HasSubstr(name));
        expect_refused({"calibrate", "tiny.yaml", "-o", name}, HasSubstr(name));
        expect_refused({"compare", ".", ".", "-o", name}, HasSubstr(name));
        expect_refused({"envelope", ".", "-o", name + ".png"}, HasSubstr(name));
        expect_refused({"check", name}, HasSubstr(name));
    }
}

TEST_F(CommandLine, FileOfTheGeometryThatIsNoneIsTold) {
    write("tiny.yaml", tiny_scene);
    for (const auto* file : {".", "/dev/zero"})
        expect_refused(
            {"check", "tiny.yaml", "--set", std::string("geometry.domain={rectangle: null, file: ") + file + "}"},
            HasSubstr("geometry.domain.file: "));
}

TEST_F(CommandLine, SceneOfAStudyThatCannotBeReadIsToldWhereTheStudyNamesIt) {
    write("binary.yaml", std::string("kluft: 1\n\0", 10));
    write("study.yaml", "title: a study\nscene: binary.yaml\nvary: {stages.0.steps: [1, 2]}\n");
    expect_refused({"study", "study.yaml"},
                   AllOf(HasSubstr("study.yaml:2:8: scene: "), HasSubstr("found a binary file")));
}

/// What a shell's command says, errors too.
std::string said_by_shell(const std::string& command) {
    FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    std::string text;
    for (int c = pipe == nullptr ? EOF : fgetc(pipe); c != EOF; c = fgetc(pipe)) text += static_cast<char>(c);
    if (pipe != nullptr) pclose(pipe);
    return text;
}

/// Candidates for the last word.
Words completed(const std::function<Result(const Words&)>& kluft, Words words) {
    words.insert(words.begin(), "complete");
    return lines_of(kluft(words).out);
}

TEST_F(CommandLine, CompletionKnowsEverySubcommandAndEveryOption) {
    const auto run = [&](const Words& words) { return kluft(words); };
    const std::regex option("--[a-z][a-z-]*");
    for (const auto& command : commands) {
        EXPECT_THAT(completed(run, {command.substr(0, 3)}), Contains(command));
        const auto candidates = completed(run, {command, "--"});
        const std::string help = kluft({command, "--help"}).out;
        const std::string options = help.substr(help.find("Options:"), help.find("Example") - help.find("Options:"));
        for (const auto& each : lines_of(options)) {
            std::smatch name;
            if (!each.starts_with("  -") || !std::regex_search(each, name, option)) continue;
            EXPECT_THAT(candidates, Contains(name.str())) << command;
        }
    }
    EXPECT_THAT(completed(run, {"ma"}), IsEmpty()); // kluft manual and kluft complete are for scripts
    EXPECT_THAT(completed(run, {"co"}), ElementsAre("compare", "completion"));
}

TEST_F(CommandLine, CompletionKnowsKeysNamesAndValuesOfAScene) {
    const auto run = [&](const Words& words) { return kluft(words); };
    write("tiny.yaml", tiny_scene);
    write("notes.txt", "");
    fs::create_directory(path("tables"));
    EXPECT_THAT(completed(run, {"run", "t"}), ElementsAre("tables/", "tiny.yaml"));
    EXPECT_THAT(completed(run, {"run", "tiny.yaml", "-o", "n"}), ElementsAre("notes.txt"));
    EXPECT_THAT(completed(run, {"run", "tiny.yaml", "--set", "out"}), ElementsAre("output."));
    EXPECT_THAT(completed(run, {"run", "tiny.yaml", "--set", "stages.1.st"}), Contains("stages.1.steps="));
    EXPECT_THAT(completed(run, {"run", "tiny.yaml", "--set", "stages."}), Contains("stages.1."));
    EXPECT_THAT(completed(run, {"check", "--set", "output.pictures="}),
                ElementsAre("output.pictures=false", "output.pictures=true"));
    EXPECT_THAT(completed(run, {"check", "--set", "analysis.plane="}), Contains("analysis.plane=strain"));
    EXPECT_THAT(completed(run, {"check", "--set", "nothing.of.the.kind."}), IsEmpty());
    EXPECT_THAT(completed(run, {"draw", "results", "--step", ""}), ElementsAre("last", "peak"));
    EXPECT_THAT(completed(run, {"validate", "incl"}), ElementsAre("incline"));
}

// As a shell asks: it splits words at '=', which the script has to undo.
TEST_F(CommandLine, BashCompletesKeysByTheScriptOfTheProgram) {
    write("ask.sh", "eval \"$('" KLUFT_PROGRAM "' completion bash)\"\nCOMP_LINE='" KLUFT_PROGRAM
                    " check --set output.pictures=t'\nCOMP_POINT=${#COMP_LINE}\n_kluft\necho \"${COMPREPLY[@]}\"\n");
    EXPECT_EQ(said_by_shell("bash " + path("ask.sh").string()), "true\n");
}

TEST_F(CommandLine, ManualHasAPageForEveryCommandThatManReads) {
    ASSERT_EQ(kluft({"manual", "man"}).code, 0);
    for (const auto& command : commands) {
        const std::string page = content_of(path("man/kluft-" + command + ".1"));
        EXPECT_THAT(page, AllOf(HasSubstr(".SH SYNOPSIS"), HasSubstr(".SH EXAMPLES"))) << command;
    }
    EXPECT_THAT(content_of(path("man/kluft-run.1")), HasSubstr("\\fB\\-\\-resume\\fR"));
    EXPECT_THAT(content_of(path("man/kluft-scene.5")), HasSubstr("\\fBmaterials.*.cohesion\\fR"));
    if (said_by_shell("command -v groff").empty()) GTEST_SKIP() << "groff is not installed";
    for (const auto& each : fs::directory_iterator(path("man"))) {
        EXPECT_EQ(said_by_shell("groff -man -ww -z -Tutf8 -Kutf8 " + each.path().string()), "");
    }
}

// ---- kluft check ---------------------------------------------------------------------------------------------------

TEST_F(CommandLine, CheckSaysWhatTheQuickStartAmountsTo) {
    const Result result = kluft({"check", model("quickstart.yaml")});
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("0.2 m x 0.4 m, plane strain"));
    EXPECT_THAT(result.out, ContainsRegex("blocks +[0-9]+\n"));
    EXPECT_THAT(result.out, ContainsRegex("unknowns +[0-9]+\n"));
    EXPECT_THAT(result.out, ContainsRegex("joint +[0-9]+  fracture"));
    EXPECT_THAT(result.out, ContainsRegex("rock_bond +[0-9]+  potential crack"));
    EXPECT_THAT(result.out, ContainsRegex("smallest +area [^ ]+ m2, edge [^ ]+ m, angle [^ ]+ deg"));
    EXPECT_THAT(result.out, HasSubstr("joint: k_n 5e+11 Pa/m, k_s 2.5e+11 Pa/m, k_n d/E 3\n")); // 500 x 0.03/5
    EXPECT_THAT(result.out, HasSubstr("k_n d/E 30"));
    EXPECT_THAT(result.out, HasSubstr("E 5e+09 Pa, nu 0.25")); // the rock's own
    EXPECT_THAT(result.out, ContainsRegex("memory +about [0-9.]+ MB"));
    EXPECT_THAT(result.out, ContainsRegex("boundary +left: 0.4 m facing \\(-1, 0\\), between .*, support none"));
    EXPECT_THAT(result.out, HasSubstr("a platen on 'top', 'bottom' rests on a fixed one"));
    EXPECT_THAT(result.out, ContainsRegex("note         .*plane strain; a cylinder"));
    EXPECT_FALSE(fs::exists(path("results")));
}

TEST_F(CommandLine, CheckSaysTheSameToPrograms) {
    const Result result = kluft({"check", model("triaxial/case-1.yaml"), "--json"});
    EXPECT_EQ(result.code, 0) << result.err;
    const auto json = nlohmann::json::parse(result.out);
    EXPECT_EQ(json.at("blocks"), 4);
    EXPECT_EQ(json.at("unknowns"), 24);
    EXPECT_EQ(json.at("plane"), "strain");
    EXPECT_EQ(json.at("stages").size(), 2U);
    EXPECT_EQ(json.at("boundaries").size(), 4U);
    EXPECT_EQ(json.at("boundaries").at(0).at("name"), "bottom");
    EXPECT_EQ(json.at("boundaries").at(0).at("normal"), (std::vector<double>{0.0, -1.0}));
    EXPECT_EQ(json.at("interface_types").at(0).at("kind"), "fracture");
    EXPECT_TRUE(json.at("warnings").empty()); // what a run of it would warn of: plane strain is a note
}

TEST_F(CommandLine, CheckTellsProgramsWhatIsWrongWhere) {
    write("bad.yaml", std::regex_replace(tiny_scene, std::regex("density"), "desnity"));
    const Result result = kluft({"check", "bad.yaml", "--json"});
    EXPECT_EQ(result.code, 2);
    const auto problems = nlohmann::json::parse(result.out).at("problems");
    ASSERT_FALSE(problems.empty());
    EXPECT_EQ(problems.at(0).at("line"), 4);
    EXPECT_THAT(problems.at(0).at("path"), "materials.rock.desnity");
    EXPECT_THAT(problems.at(0).at("message").get<std::string>(), HasSubstr("density"));
    EXPECT_THAT(result.err, HasSubstr("desnity"));
    const auto absent = nlohmann::json::parse(kluft({"check", "absent.yaml", "--json"}).out).at("problems");
    EXPECT_EQ(absent.size(), 1U);
}

TEST_F(CommandLine, CheckAcceptsEveryTriaxialCase) {
    int n_cases = 0;
    for (const auto& entry : fs::directory_iterator(model("triaxial"))) {
        const std::string name = entry.path().filename();
        if (!name.starts_with("case-")) continue;
        ++n_cases;
        const Result result = kluft({"check", entry.path()});
        EXPECT_EQ(result.code, 0) << name << result.err;
        EXPECT_THAT(result.out, AllOf(HasSubstr("0.38 m x 1 m"), HasSubstr("a cylinder"))) << name;
    }
    EXPECT_GE(n_cases, 6);
}

// Six unknowns a block.
TEST_F(CommandLine, CheckCountsSixUnknownsPerBlock) {
    const std::string out = kluft({"check", model("triaxial/case-1.yaml")}).out;
    EXPECT_THAT(out, ContainsRegex("blocks +4\n")); // three fractures that meet cut the rectangle into four
    EXPECT_THAT(out, ContainsRegex("unknowns +24\n"));
}

// ---- errors in scenes ----------------------------------------------------------------------------------------------

struct WrongScene {
    const char* what;
    const char* text;     ///< in the tiny scene
    const char* replaced; ///< by this
    const char* message;  ///< a part of the answer
};

void PrintTo(const WrongScene& scene, std::ostream* stream) { *stream << scene.what; }

class WrongScenes : public CommandLine, public ::testing::WithParamInterface<WrongScene> {};

TEST_P(WrongScenes, AreRefusedByLineAndLeaveNothing) {
    std::string text = tiny_scene;
    const std::size_t at = text.find(GetParam().text);
    ASSERT_NE(at, std::string::npos);
    text.replace(at, std::string(GetParam().text).size(), GetParam().replaced);
    write("wrong.yaml", text);
    const auto line = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n') + 1;
    expect_refused({"run", "wrong.yaml"},
                   AllOf(StartsWith(fmt::format("wrong.yaml:{}:", line)), HasSubstr(GetParam().message)));
    EXPECT_EQ(lines_of(content_of(path(".stderr"))).size(), 2U); // the message and the line of the scene
    EXPECT_FALSE(fs::exists(path("results")));
}

INSTANTIATE_TEST_SUITE_P(
    All, WrongScenes,
    ::testing::Values(
        WrongScene{"UnknownKey", "density", "densty", "did you mean 'density'?"},
        WrongScene{"WrongType", "steps: 8", "steps: many", "stages.1.steps: expected an integer >= 1, found 'many'"},
        WrongScene{"WrongDimension", "1500 MPa", "1500 m", "which is in m"},
        WrongScene{"OutOfRange", "poissons_ratio: 0.25", "poissons_ratio: 0.7", "expected a number >= 0 and < 0.5"},
        WrongScene{"NotANumber", "1500 MPa", ".nan", "not finite"},
        WrongScene{"UndefinedInterface", "interface: bond", "interface: bnd", "did you mean 'bond'?"},
        WrongScene{"EmptyGeometry", "{rectangle: {width: 0.2, height: 0.4}}", "{}", "geometry.domain"},
        WrongScene{"UnknownSupport", "support: smooth", "support: smoth", "did you mean 'smooth'?"}),
    [](const auto& each) { return std::string(each.param.what); });

TEST_F(CommandLine, SceneThatExtendsItselfIsRefused) {
    write("a.yaml", "extends: b.yaml\n");
    write("b.yaml", "extends: a.yaml\n");
    expect_refused({"run", "a.yaml"}, HasSubstr("leads back to itself"));
    EXPECT_FALSE(fs::exists(path("results")));
}

TEST_F(CommandLine, EmptySceneIsRefused) {
    write("empty.yaml", "");
    expect_refused({"run", "empty.yaml"}, HasSubstr("found an empty file"));
}

TEST_F(CommandLine, OverrideOfAnUnknownKeyIsRefusedWithTheNearestKey) {
    write("tiny.yaml", tiny_scene);
    expect_refused({"run", "tiny.yaml", "--set", "stges.1.steps=2"},
                   AllOf(StartsWith("--set stges.1.steps=2"), HasSubstr("did you mean 'stages'?")));
    expect_refused({"run", "tiny.yaml", "--set", "stages.7.steps=2"}, HasSubstr("index from 0 to 2"));
    expect_refused({"run", "tiny.yaml", "--set", "steps"}, HasSubstr("key.path=value"));
    EXPECT_FALSE(fs::exists(path("results")));
}

const char* const pressed_scene = R"(kluft: 1
analysis: {plane: stress}
materials: {rock: {youngs_modulus: 1 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e9, shear_stiffness: 1e9, friction_angle: 30}}
geometry:
  domain: {rectangle: {width: 4.0, height: 1.5}}
  fractures: [{trace: [[-1, 0.5], [5, 0.5]], interface: joint}]
  reference_spacing: 1.0
boundaries: {bottom: {support: fixed}}
stages: [{name: weight, pressure: {top: 1 MPa}, steps: 2}]
)";

TEST_F(CommandLine, RunWithoutAPlatenHasNoCurve) {
    write("pressed.yaml", pressed_scene);
    const Result result = kluft({"run", "pressed.yaml", "-o", "r"});
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_THAT(result.out, Not(HasSubstr("peak axial stress")));
    EXPECT_TRUE(fs::exists(path("r/blocks.png")));
    EXPECT_FALSE(fs::exists(path("r/curve.png")));
    EXPECT_EQ(kluft({"draw", "r"}).code, 0);
    EXPECT_FALSE(fs::exists(path("r/curve.png")));
    expect_refused({"draw", "r", "--curve"}, HasSubstr("expected a run that moves a platen"));
}

TEST_F(CommandLine, WarningsOfARunStandInItsSummary) {
    write("pressed.yaml", pressed_scene);
    const std::string outside = "geometry.fractures.1={trace: [[10, 10], [11, 11]], interface: joint}";
    EXPECT_EQ(kluft({"run", "pressed.yaml", "-o", "r", "--set", outside}).code, 0);
    const auto warnings = summary("r")["warnings"];
    ASSERT_GE(warnings.size(), 1U);
    EXPECT_THAT(warnings[0].get<std::string>(), HasSubstr("lies outside the domain"));
}

// ---- kluft run -----------------------------------------------------------------------------------------------------

const Words all_files{"history.csv", "equilibria.csv", "cracks.csv", "jumps.csv",  "summary.json",
                      "fields.pvd",  "curve.png",      "curve.svg",  "blocks.png", "blocks.svg",
                      "run.log",     "state.h5",       "scene.yaml"};

void expect_all_files(const fs::path& run) {
    for (const auto& name : all_files) EXPECT_GT(fs::file_size(run / name), 0U) << name;
    for (const auto& entry : fs::recursive_directory_iterator(run)) EXPECT_NE(entry.path().extension(), ".part");
    for (const char* name : {"curve.png", "blocks.png"}) EXPECT_THAT(content_of(run / name), StartsWith("\x89PNG"));
    for (const char* name : {"curve.svg", "blocks.svg"}) EXPECT_THAT(content_of(run / name), HasSubstr("</svg>"));
    const std::string pvd = content_of(run / "fields.pvd");
    const std::regex reference("file=\"([^\"]+)\"");
    std::set<std::string> files;
    for (std::sregex_iterator found(pvd.begin(), pvd.end(), reference), end; found != end; ++found)
        files.insert((*found)[1]);
    EXPECT_GE(files.size(), 2U);
    for (const auto& file : files) EXPECT_THAT(content_of(run / file), HasSubstr("</VTKFile>")) << file;
}

TEST_F(CommandLine, RunLeavesEverythingOfTheContract) {
    write("tiny.yaml", tiny_scene);
    const Result result = kluft({"run", "tiny.yaml"});
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_THAT(result.out, AllOf(StartsWith("done: peak"), HasSubstr("results in results/tiny")));
    expect_all_files(path("results/tiny"));
    const auto history = lines_of(content_of(path("results/tiny/history.csv")));
    const std::string columns =
        "step,stage,load_factor,axial_strain,axial_stress,lateral_strain,lateral_stress,differential_stress,"
        "volumetric_strain,cracks_tension,cracks_shear,open,sliding,locked,open_close_iterations,crack_passes,"
        "unbalanced_ratio,balance_error,jumps,net_broken,balanced,elapsed_s";
    EXPECT_EQ(history.front(), columns);
    EXPECT_EQ(history.size(), 1U + 1U + 2U + 8U); // columns, initial state, steps of the two stages
    EXPECT_EQ(lines_of(content_of(path("results/tiny/equilibria.csv"))).front(), columns);
    EXPECT_EQ(lines_of(content_of(path("results/tiny/cracks.csv"))).front(),
              "step,pass,interface,x,y,mode,p1,p3,axial_strain");
    const auto json = summary("results/tiny");
    EXPECT_EQ(json["status"], "done");
    EXPECT_EQ(json["steps"], 10);
    for (const char* key :
         {"peak_stress", "peak_strain", "peak_reached", "net_locked", "residual_stress", "youngs_modulus",
          "poissons_ratio", "cracks_tension", "cracks_shear", "blocks", "interfaces", "unknowns", "unbalanced_steps",
          "open_close_iterations", "factorizations", "analyses", "elapsed_s", "peak_memory_bytes", "version"})
        EXPECT_TRUE(json.contains(key)) << key;
}

// Rough joints lock hexagons (docs/theory.md, blocks): the numbers come from the tables, also of a run that goes on.
TEST_F(CommandLine, LockedNetIsSaidAtTheStartAndAtTheEnd) {
    write("locked.yaml", tiny_scene);
    const std::vector<std::string> words{"run",   "locked.yaml",
                                         "-o",    "r",
                                         "--set", "interfaces.joint.friction_angle=40",
                                         "--set", "output={pictures: false, fields: false}"};
    const Result result = kluft(words);
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("warning: --set interfaces.joint.friction_angle=40: "
                                      "interfaces.joint.friction_angle: 40 deg lets the net lock"));
    EXPECT_THAT(result.out, HasSubstr(" before the net locked"));
    EXPECT_THAT(content_of(path("r/run.log")),
                AllOf(HasSubstr("lets the net lock"), HasSubstr("before the net locked")));
    const auto json = summary("r");
    EXPECT_EQ(json["net_locked"], true);
    EXPECT_EQ(json["peak_reached"], false);
    std::vector<std::string> again = words;
    again.emplace_back("--resume");
    ASSERT_EQ(kluft(again).code, 0);
    EXPECT_EQ(summary("r")["net_locked"], true);
    EXPECT_EQ(summary("r")["peak_stress"], json["peak_stress"]);
    const Result check = kluft({"check", "locked.yaml", "--set", "interfaces.joint.friction_angle=40"});
    EXPECT_THAT(check.out, AllOf(HasSubstr("lets the net lock"), HasSubstr("k_n d/E is 0.133 with the E of rock")));
}

TEST_F(CommandLine, RunThatStopsAfterADropSaysSo) {
    write("tiny.yaml", tiny_scene);
    const Result result = kluft({"run", "tiny.yaml", "-o", "r", "--set", "stages.1.stop_after_drop=20 %", "--set",
                                 "interfaces.joint.friction_angle=10", "--set", "stages.1.steps=20"});
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_THAT(result.out,
                AllOf(HasSubstr(", stopped in stage 1 at load step "), HasSubstr("(stop_after_drop: 20 %)")));
    EXPECT_THAT(content_of(path("r/run.log")), HasSubstr("stopped in stage 1 at load step "));
    EXPECT_EQ(summary("r")["status"], "done");
    EXPECT_EQ(summary("r")["peak_reached"], true);
    EXPECT_THAT(summary("r")["message"].get<std::string>(), StartsWith("stopped in stage 1"));
    expect_all_files(path("r"));
}

TEST_F(CommandLine, CheckSaysWhereARunWouldFollowLoosePieces) {
    write("tiny.yaml", tiny_scene);
    const std::vector<std::string> unconfined{"check", "tiny.yaml", "--set",
                                              "stages.0.pressure={left: 0, right: 0, top: 0}", "--set"};
    const auto said_with = [&](const std::string& assignment) {
        std::vector<std::string> words = unconfined;
        words.push_back(assignment);
        return kluft(words).out;
    };
    EXPECT_THAT(said_with("stages.1.steps=8"), HasSubstr("stages.1.stop_after_drop: 80 % ends it behind the peak"));
    EXPECT_THAT(said_with("stages.1.stop_after_drop=80 %"), Not(HasSubstr("ends it behind the peak")));
    EXPECT_THAT(said_with("stages.1.strain.value=-1 %"), Not(HasSubstr("ends it behind the peak"))); // pulled
    EXPECT_THAT(kluft({"check", "tiny.yaml"}).out, Not(HasSubstr("ends it behind the peak")));
}

TEST_F(CommandLine, ResumedRunSaysThatNothingWasSaved) {
    write("tiny.yaml", tiny_scene);
    fs::create_directories(path("r"));
    expect_refused({"run", "tiny.yaml", "-o", "r", "--resume"},
                   HasSubstr("state.h5: expected a state to go on from, found none: no run in r has saved one yet"));
}

TEST_F(CommandLine, QuietRunSaysNothing) {
    write("tiny.yaml", tiny_scene);
    const Result result = kluft({"run", "tiny.yaml", "--quiet", "-o", "r"});
    EXPECT_EQ(result.code, 0);
    EXPECT_THAT(result.out + result.err, IsEmpty());
}

#if defined(__x86_64__)
// OpenBLAS takes "Prescott" for a processor that it does not know; given by the user it stays, found by the BLAS it does not.
TEST_F(CommandLine, KernelsOfTheBlasThatTheUserChoseStay) {
    write("scene.yaml", tiny_scene);
    setenv("OPENBLAS_CORETYPE", "Prescott", 1);
    const int code = kluft({"run", "scene.yaml", "-o", "run", "--quiet"}).code;
    unsetenv("OPENBLAS_CORETYPE");
    ASSERT_EQ(code, 0);
    EXPECT_EQ(summary("run").at("blas_core"), "Prescott");
}

TEST_F(CommandLine, KernelsOfTheBlasThatComputeRightlyAreUsedInASecondStart) {
    write("scene.yaml", tiny_scene);
    setenv("OPENBLAS_CORETYPE", "Prescott", 1);
    setenv("KLUFT_OWN_BLAS_CORE", "Prescott", 1); // as the first start leaves it
    const int code = kluft({"run", "scene.yaml", "-o", "run", "--quiet"}).code;
    unsetenv("OPENBLAS_CORETYPE");
    unsetenv("KLUFT_OWN_BLAS_CORE");
    ASSERT_EQ(code, 0);
    EXPECT_EQ(summary("run").at("blas_core"), "Prescott");
}
#endif

TEST_F(CommandLine, OverrideTakesEffectAndIsLogged) {
    write("tiny.yaml", tiny_scene);
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--set", "stages.1.steps=3", "--set", "title=Other"}).code, 0);
    EXPECT_EQ(summary("r")["steps"], 5);
    EXPECT_EQ(summary("r")["title"], "Other");
    EXPECT_THAT(content_of(path("r/run.log")), HasSubstr("--set stages.1.steps=3"));
}

TEST_F(CommandLine, NewRunReplacesTheResultsOfAnOldOneAndKeepsForeignFiles) {
    write("tiny.yaml", tiny_scene);
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r"}).code, 0);
    write("r/notes.txt", "mine");
    const Words other{"run", "tiny.yaml", "-o", "r", "--set", "stages.1.steps=3", "--set", "output.pictures=false"};
    ASSERT_EQ(kluft(with(other, {"--force"})).code, 0);
    EXPECT_EQ(content_of(path("r/notes.txt")), "mine");
    EXPECT_FALSE(fs::exists(path("r/curve.png")));
    EXPECT_EQ(lines_of(content_of(path("r/history.csv"))).size(), 7U);
    EXPECT_THAT(content_of(path("r/scene.yaml")), HasSubstr("steps: 3}"));
    EXPECT_EQ(kluft(other).code, 0); // the results are of this scene now
}

TEST_F(CommandLine, ResultsOfAnotherSceneAreNotReplacedInSilence) {
    write("tiny.yaml", tiny_scene);
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--quiet"}).code, 0);
    const auto before = files_in("r");
    const Words other{"run", "tiny.yaml", "-o", "r", "--set", "stages.1.steps=3"};
    expect_refused(other, AllOf(StartsWith("r: expected results of this scene or none, found results of another one: "
                                           "stages.1.steps is '8' there and '3' here"),
                                HasSubstr("--force"), HasSubstr("--resume")));
    EXPECT_TRUE(files_in("r") == before);
    expect_refused(with(other, {"--resume", "--force"}), HasSubstr("--resume excludes --force"));
    EXPECT_TRUE(files_in("r") == before);
    expect_refused(
        with(other, {"--resume"}),
        HasSubstr("belongs to another scene: stages.1.steps is '8' there and '3' here; a run "
                  "goes on with other keys of solver, cracks (not strength_noise and strength_seed) and output"));
    auto after = files_in("r");
    after[".lock"] = before.at(".lock"); // names the last process
    EXPECT_TRUE(after == before);
}

TEST_F(CommandLine, SameSceneIsRunAnewWhateverItsCommentsAndTheOrderOfItsKeys) {
    write("tiny.yaml", tiny_scene);
    write("again.yaml", std::string("# the same\nboundaries: {bottom: {support: smooth}}  # at the foot\n") +
                            std::regex_replace(tiny_scene, std::regex("\nboundaries: .*\n"), "\n\n"));
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--quiet"}).code, 0);
    const std::string history = table("r/history.csv");
    write("r/history.csv", "old");
    ASSERT_EQ(kluft({"run", "again.yaml", "-o", "r", "--quiet"}).code, 0);
    EXPECT_EQ(table("r/history.csv"), history);
}

/// Results of a program before there was a scene.yaml name their scene in the saved state, if there is one.
TEST_F(CommandLine, ResultsWithoutASceneAreReplacedWhereTheirStateIsOfTheSameScene) {
    write("tiny.yaml", tiny_scene);
    const Words words{"run", "tiny.yaml", "-o", "r", "--quiet"}, other = with(words, {"--set", "stages.1.steps=3"});
    ASSERT_EQ(kluft(words).code, 0);
    fs::remove(path("r/scene.yaml"));
    expect_refused(other, HasSubstr("stages.1.steps is '8' there and '3' here"));
    EXPECT_EQ(kluft(words).code, 0);
    fs::remove(path("r/scene.yaml"));
    fs::remove(path("r/state.h5"));
    expect_refused(words, HasSubstr("found history.csv and no scene.yaml that says what it is of; --force"));
    EXPECT_EQ(kluft(with(words, {"--force"})).code, 0);
    fs::create_directory(path("mine"));
    write("mine/cracks.csv", "measured");
    expect_refused({"run", "tiny.yaml", "-o", "mine"},
                   HasSubstr("mine: expected results of this scene or none, found cracks.csv"));
    EXPECT_EQ(content_of(path("mine/cracks.csv")), "measured");
    fs::remove(path("mine/cracks.csv"));
    fs::create_directory(path("mine/contacts"));
    for (const std::string name : {"run.log", "contacts/000000.csv"}) {
        write("mine/" + name, "measured");
        expect_refused({"run", "tiny.yaml", "-o", "mine"}, HasSubstr("found " + name + " and no scene.yaml"));
        EXPECT_EQ(content_of(path("mine/" + name)), "measured");
        fs::remove(path("mine/" + name));
    }
}

TEST_F(CommandLine, SceneThatWasChangedBesideItsResultsIsAnotherOne) {
    write("tiny.yaml", tiny_scene);
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--quiet"}).code, 0);
    EXPECT_EQ(kluft({"run", "r/scene.yaml", "-o", "r", "--quiet"}).code, 0);
    write("r/scene.yaml", std::regex_replace(content_of(path("r/scene.yaml")), std::regex("steps: 8"), "steps: 3"));
    const auto before = files_in("r");
    expect_refused({"run", "r/scene.yaml", "-o", "r"}, HasSubstr("scene.yaml has been changed since"));
    EXPECT_TRUE(files_in("r") == before);
    EXPECT_EQ(kluft({"run", "r/scene.yaml", "-o", "r", "--force"}).code, 0);
    EXPECT_EQ(summary("r")["steps"], 5);
}

TEST_F(CommandLine, SceneOfTheUsersOwnInTheDirectoryOfTheResultsIsNotReplaced) {
    fs::create_directory(path("mine"));
    write("mine/scene.yaml", std::string("# by hand\n") + tiny_scene);
    const std::string before = content_of(path("mine/scene.yaml"));
    const Words words{"run", "mine/scene.yaml", "-o", "mine", "--quiet"};
    for (int i = 0; i < 2; ++i) EXPECT_EQ(kluft(words).code, 0);
    EXPECT_EQ(kluft(with(words, {"--resume"})).code, 0);
    for (const char* option : {"--quiet", "--force"})
        expect_refused({"run", "mine/scene.yaml", "-o", "mine", "--set", "title=Other", option},
                       AnyOf(HasSubstr("title is 'Tiny' there and 'Other' here"),
                             AllOf(StartsWith("mine/scene.yaml: "), HasSubstr("would be lost"), HasSubstr("-o"))));
    EXPECT_EQ(content_of(path("mine/scene.yaml")), before);
    write("mine/scene.yaml", std::regex_replace(tiny_scene, std::regex("steps: 8"), "steps: 3"));
    expect_refused(words, HasSubstr("stages.1.steps is '8' there and '3' here"));
    EXPECT_EQ(kluft(with(words, {"--force"})).code, 0);
}

TEST_F(CommandLine, SceneInTheResultsGivesTheSameTablesElsewhere) {
    write("tiny.yaml", tiny_scene);
    fs::create_directories(path("maps/traces"));
    write(
        "maps/base.yaml",
        std::regex_replace(tiny_scene, std::regex("  tessellation"),
                           "  fractures: [{name: mapped, file: traces/t.geojson, interface: joint}]\n  tessellation"));
    write("maps/traces/t.geojson", R"({"type": "LineString", "coordinates": [[-1, 0.13], [1, 0.24]]})");
    write("steep.yaml", "extends: maps/base.yaml\ninterfaces: {joint: {friction_angle: 25 deg}}\n");
    const Words set{"--quiet",
                    "--set",
                    "solver.repeatable=true",
                    "--set",
                    "output.pictures=false",
                    "--set",
                    "stages.1.strain.value=0.8 %"};
    for (const char* scene : {"tiny.yaml", "steep.yaml"}) {
        ASSERT_EQ(kluft(with({"run", scene, "-o", "first", "--force"}, set)).code, 0);
        fs::create_directory(path("away"));
        fs::rename(path("first/scene.yaml"), path("away/scene.yaml"));
        ASSERT_EQ(kluft({"run", "away/scene.yaml", "-o", "away/again", "--quiet", "--force"}).code, 0);
        for (const std::string name : {"history.csv", "equilibria.csv"})
            EXPECT_TRUE(table("first/" + name) == table("away/again/" + name)) << scene << ' ' << name;
        for (const std::string name : {"cracks.csv", "jumps.csv"})
            EXPECT_TRUE(content_of(path("first/" + name)) == content_of(path("away/again/" + name))) << scene;
        EXPECT_EQ(content_of(path("away/again/scene.yaml")), content_of(path("away/scene.yaml")));
        EXPECT_EQ(summary("away/again")["title"], summary("first")["title"]);
        fs::remove_all(path("away"));
    }
}

TEST_F(CommandLine, SceneWhoseFileOfTracesHasChangedIsAnotherOne) {
    write("base.yaml",
          std::regex_replace(tiny_scene, std::regex("  tessellation"),
                             "  fractures: [{name: mapped, file: t.geojson, interface: joint}]\n  tessellation"));
    const std::string traces = R"({"type": "LineString", "coordinates": [[-1, 0.13], [1, 0.24]]})";
    write("t.geojson", traces);
    const Words words{"run", "base.yaml", "-o", "r", "--quiet"};
    ASSERT_EQ(kluft(words).code, 0);
    write("t.geojson", std::regex_replace(traces, std::regex("0.13"), "0.14"));
    expect_refused(words, HasSubstr("a file of the geometry has another content"));
    write("t.geojson", traces);
    EXPECT_EQ(kluft(words).code, 0);
}

/// Killed as soon as scene.yaml is there: the same command runs, and nothing of it is torn.
TEST_F(CommandLine, RunThatWasKilledRightAfterItsSceneWasWrittenIsRunAnew) {
    write("tiny.yaml", tiny_scene);
    const Words words{"run", "tiny.yaml", "-o", "r"};
    Child child(directory_.path(), words);
    for (int i = 0; i < 30000 && !fs::exists(path("r/scene.yaml")); ++i)
        std::this_thread::sleep_for(std::chrono::microseconds(200));
    child.send(SIGKILL);
    ASSERT_EQ(child.wait(), 128 + SIGKILL);
    const std::string scene = content_of(path("r/scene.yaml"));
    for (const auto& [name, content] : files_in("r"))
        if (name != "scene.yaml" && name != ".lock") fs::remove_all(path("r/" + name)); // as if killed earlier still
    EXPECT_EQ(kluft({"run", "r/scene.yaml", "-o", "other", "--quiet"}).code, 0);
    EXPECT_EQ(kluft(words).code, 0);
    EXPECT_EQ(content_of(path("r/scene.yaml")), scene);
    expect_all_files(path("r"));
}

TEST_F(CommandLine, ResumedRunLeavesTheSceneThatItWasResumedWith) {
    write("tiny.yaml", tiny_scene);
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--quiet"}).code, 0);
    const Words resume{"run", "tiny.yaml", "-o", "r", "--quiet", "--resume", "--set", "output.pictures=false"};
    ASSERT_EQ(kluft(resume).code, 0);
    EXPECT_THAT(content_of(path("r/scene.yaml")), HasSubstr("pictures: false"));
}

TEST_F(CommandLine, ResultsAtOrBelowALinkToNothingAreRefused) {
    write("tiny.yaml", tiny_scene);
    fs::create_symlink("gone", path("link"));
    fs::create_symlink("gone.png", path("link.png"));
    const auto names_the_link =
        HasSubstr("link: expected a place for the results, found a link to gone, which is not there");
    expect_refused({"run", "tiny.yaml", "-o", "link"}, names_the_link);
    expect_refused({"run", "tiny.yaml", "-o", "link/below"}, names_the_link);
    expect_refused({"study", "step-size", "tiny.yaml", "-o", "link"}, names_the_link);
    expect_refused({"draw", "tiny.yaml", "-o", "link.png"}, HasSubstr("found a link to gone.png"));
    fs::create_directory(path("gone"));
    EXPECT_EQ(kluft({"run", "tiny.yaml", "-o", "link", "--quiet"}).code, 0);
}

TEST_F(CommandLine, RunIsRefusedWhereItsDirectoryIsAFile) {
    write("tiny.yaml", tiny_scene);
    expect_refused({"run", "tiny.yaml", "-o", "tiny.yaml"}, HasSubstr("expected a directory for the results"));
    EXPECT_EQ(content_of(path("tiny.yaml")), tiny_scene);
}

TEST_F(CommandLine, DirectoryWhoseNameIsTooLongIsRefused) {
    write("tiny.yaml", tiny_scene);
    expect_refused({"run", "tiny.yaml", "-o", std::string(300, 'a')}, HasSubstr("File name too long"));
}

TEST_F(CommandLine, BodyThatSlidesAwayEndsWithExitCode3AndIsNamed) {
    write("slide.yaml", sliding_scene);
    const Result result = kluft({"run", "slide.yaml", "-o", "r"});
    EXPECT_EQ(result.code, 3);
    EXPECT_THAT(result.err,
                ContainsRegex("no equilibrium in stage 1 .*block 1 at \\(2, 1\\).*interfaces 0 moves towards"));
    EXPECT_EQ(summary("r")["status"], "no_equilibrium");
    EXPECT_GE(summary("r")["unbalanced_steps"], 10);
    EXPECT_EQ(kluft({"draw", "r", "-o", "again.png"}).code, 0);
    EXPECT_GT(fs::file_size(path("again.png")), 0U);
}

TEST_F(CommandLine, BodyThatNothingHoldsEndsWithExitCode3) {
    write("loose.yaml", loose_scene);
    const Result result = kluft({"run", "loose.yaml", "-o", "r"});
    EXPECT_EQ(result.code, 3);
    EXPECT_THAT(result.err, HasSubstr("nothing holds the body"));
    EXPECT_EQ(summary("r")["status"], "no_equilibrium");
    EXPECT_EQ(lines_of(content_of(path("r/history.csv"))).size(), 2U); // no step was committed
    EXPECT_EQ(kluft({"draw", "r", "-o", "again.png"}).code, 0);
}

// ---- interruption and resumption -----------------------------------------------------------------------------------

const Words long_run{"run",   model("quickstart.yaml"), "--quiet", "--set", "stages.1.steps=120",
                     "--set", "solver.repeatable=true"};

TEST_F(SlowCommandLine, InterruptedRunIsCompleteAndGoesOnAsIfItHadNotBeenInterrupted) {
    ASSERT_EQ(kluft(with(long_run, {"-o", "whole"})).code, 0);
    Child child(directory_.path(), with(long_run, {"-o", "broken"}));
    const auto n_rows = [&] {
        return fs::exists(path("broken/history.csv")) ? lines_of(content_of(path("broken/history.csv"))).size() : 0U;
    };
    wait_for_rows("broken", 20);
    child.interrupt();
    ASSERT_EQ(child.wait(), 130);
    expect_all_files(path("broken"));
    EXPECT_EQ(summary("broken")["status"], "interrupted");
    const std::size_t rows_so_far = n_rows();
    EXPECT_GE(rows_so_far, 20U);
    ASSERT_LT(rows_so_far, 124U);
    const Result resumed = kluft(with(long_run, {"-o", "broken", "--resume"}));
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    for (const char* name : {"history.csv", "equilibria.csv"})
        EXPECT_TRUE(table(std::string("broken/") + name) == table(std::string("whole/") + name)) << name;
    EXPECT_TRUE(content_of(path("broken/cracks.csv")) == content_of(path("whole/cracks.csv")));
    EXPECT_TRUE(content_of(path("broken/jumps.csv")) == content_of(path("whole/jumps.csv")));
    // Costs are those of both parts.
    EXPECT_EQ(summary("broken")["open_close_iterations"], summary("whole")["open_close_iterations"]);
    EXPECT_EQ(summary("broken")["factorizations"], summary("whole")["factorizations"]);
    EXPECT_GT(summary("broken")["seconds"]["factorization"], 0.0);
    expect_all_files(path("broken"));
}

TEST_F(SlowCommandLine, RunKeepsOthersOutOfItsDirectory) {
    write("tiny.yaml", tiny_scene);
    write("study.yaml", "scene: tiny.yaml\nvary: {stages.1.steps: [4]}\n");
    Child child(directory_.path(), with(long_run, {"-o", "r"}));
    wait_for_rows("r", 5);
    const auto named = ContainsRegex("^r: expected .* found process [0-9]+ .*kluft run .*--force.*--resume");
    expect_refused({"run", "tiny.yaml", "-o", "r"}, named);
    expect_refused({"run", "tiny.yaml", "-o", "r", "--force"}, named);
    expect_refused(with(long_run, {"-o", "r", "--resume"}), named);
    expect_refused({"study", "study.yaml", "-o", "r"}, ContainsRegex("found process [0-9]+ .*kluft run "));
    child.interrupt();
    ASSERT_EQ(child.wait(), 130);
    EXPECT_GE(lines_of(content_of(path("r/history.csv"))).size(), 5U);
    Child killed(directory_.path(), with(long_run, {"-o", "r"}));
    wait_for_rows("r", 5);
    killed.send(SIGKILL);
    ASSERT_EQ(killed.wait(), 128 + SIGKILL);
    EXPECT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--force"}).code, 0); // what it had locked is free
}

// What a shell says of a process that a signal has ended, but with the state and a summary.
TEST_F(SlowCommandLine, SignalsInterruptARunAndTheExitCodeNamesThem) {
    for (const int signal : {SIGHUP, SIGQUIT, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU, SIGALRM}) {
        Child child(directory_.path(), with(long_run, {"-o", "r", "--set", "output.pictures=false"}));
        wait_for_rows("r", 8);
        child.send(signal);
        EXPECT_EQ(child.wait(), 128 + signal);
        EXPECT_EQ(summary("r")["status"], "interrupted") << signal;
        EXPECT_TRUE(fs::exists(path("r/state.h5")));
        EXPECT_THAT(read_state_tables(path("r/state.h5")),
                    HasSubstr(fmt::format("history.csv {} ", fs::file_size(path("r/history.csv")))));
        fs::remove_all(path("r"));
    }
}

TEST_F(SlowCommandLine, SignalsOfWritingEndNothing) {
    const Words before_the_peak{
        "-o", "r", "--set", "stages.1.strain.value=0.2 %", "--set", "geometry.tessellation.triangles.spacing=0.012"};
    Child child(directory_.path(), with(long_run, before_the_peak));
    wait_for_rows("r", 8);
    for (const int signal : {SIGPIPE, SIGXFSZ}) child.send(signal);
    EXPECT_EQ(child.wait(), 0);
    EXPECT_EQ(summary("r")["status"], "done");
}

// Killed in the midst of a stage, at whose end a state would be saved by default: the clock has saved one before.
TEST_F(SlowCommandLine, KilledRunGoesOnFromAStateThatTheClockHasSaved) {
    ASSERT_EQ(kluft(with(long_run, {"-o", "whole"})).code, 0);
    const Words words = with(long_run, {"-o", "broken", "--set", "output.checkpoint_seconds=1e-9"});
    Child child(directory_.path(), words);
    wait_for_rows("broken", 30);
    child.send(SIGKILL);
    ASSERT_EQ(child.wait(), 128 + SIGKILL);
    std::istringstream saved(read_state_tables(path("broken/state.h5")));
    std::string name;
    std::size_t bytes = 0;
    saved >> name >> bytes;
    EXPECT_EQ(name, "history.csv");
    EXPECT_GE(lines_of(content_of(path("broken/history.csv")).substr(0, bytes)).size(), 28U);
    ASSERT_EQ(kluft(with(words, {"--resume"})).code, 0);
    for (const char* table_name : {"history.csv", "equilibria.csv"})
        EXPECT_TRUE(table(std::string("broken/") + table_name) == table(std::string("whole/") + table_name));
    EXPECT_TRUE(content_of(path("broken/cracks.csv")) == content_of(path("whole/cracks.csv")));
}

TEST_F(CommandLine, ResumingIsRefusedWhereATableHasLostRows) {
    write("tiny.yaml", tiny_scene);
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r"}).code, 0);
    for (const std::string name : {"history.csv", "equilibria.csv", "cracks.csv", "jumps.csv"}) {
        const std::string before = content_of(path("r/" + name));
        const std::string damaged =
            before.substr(0, before.rfind('\n', before.size() - 2) + 1); // without the last line
        write("r/" + name, damaged);
        expect_refused({"run", "tiny.yaml", "-o", "r", "--resume"},
                       StartsWith("r/" + name + (damaged.empty() ? ":1: expected the columns" : ": expected the ")));
        EXPECT_EQ(content_of(path("r/" + name)), damaged);
        write("r/" + name, before);
    }
    EXPECT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--resume"}).code, 0);
}

TEST_F(CommandLine, FinishedRunIsResumedWithoutChange) {
    write("tiny.yaml", tiny_scene);
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r"}).code, 0);
    const std::string before = content_of(path("r/history.csv"));
    const auto factorizations = summary("r")["factorizations"];
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--resume"}).code, 0);
    EXPECT_EQ(content_of(path("r/history.csv")), before);
    EXPECT_EQ(summary("r")["factorizations"], factorizations);
}

// Two blocks on a fixed one, pushed until the upper one slides.
const char* const masonry_scene = R"(kluft: 1
analysis: {gravity: 10}
materials: {stone: {density: 2000, youngs_modulus: 1 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, normal_stiffness: 10 GPa/m, shear_stiffness: 10 GPa/m, friction_angle: 30}}
geometry:
  blocks:
    - {name: base, polygon: [[-1, -1], [3, -1], [3, 0], [-1, 0]], support: fixed}
    - {name: lower, polygon: [[0, 0], [2, 0], [2, 1], [0, 1]]}
    - {name: upper, polygon: [[0.5, 1], [1.5, 1], [1.5, 2], [0.5, 2]]}
stages:
  - {name: weight, steps: 2}
  - {name: push, forces: {push: {block: upper, point: [0.5, 1.2], force: [10 kN/m, 0]}}, steps: 4}
output: {checkpoint_every: 1, histories: {seam: {interface: [lower, upper]}, upper: {block: upper}}}
)";

TEST_F(CommandLine, GivenBlocksAreCheckedDrawnRunAndFollowed) {
    write("masonry.yaml", masonry_scene);
    const Result checked = kluft({"check", "masonry.yaml"});
    EXPECT_EQ(checked.code, 0) << checked.err;
    EXPECT_THAT(checked.out, ContainsRegex("blocks +3\n"));
    EXPECT_EQ(kluft({"draw", "masonry.yaml"}).code, 0);
    const Result result = kluft({"run", "masonry.yaml", "-o", "r"});
    ASSERT_EQ(result.code, 0) << result.err;
    const auto rows = lines_of(content_of(path("r/histories.csv")));
    ASSERT_EQ(rows.size(), 8U);
    EXPECT_THAT(rows[0], StartsWith("step,stage,load_factor,seam.normal_force,"));
    EXPECT_THAT(rows[1], StartsWith("0,0,0,0,0,"));
    ASSERT_EQ(kluft({"run", "masonry.yaml", "-o", "r", "--resume"}).code, 0);
    EXPECT_EQ(lines_of(content_of(path("r/histories.csv"))), rows);
    EXPECT_EQ(kluft({"draw", "r"}).code, 0);
}

TEST_F(CommandLine, GivenBlockThatSlidesAwayIsCalledByItsName) {
    write("masonry.yaml", masonry_scene);
    const Result result = kluft({"run", "masonry.yaml", "-o", "r", "--set", "stages.1.forces.push.force=[30 kN/m, 0]"});
    EXPECT_THAT(result.err, HasSubstr("block 'upper' at (1, 1.5)"));
    EXPECT_EQ(summary("r")["status"], "no_equilibrium");
    EXPECT_EQ(summary("r")["falling_blocks"][0]["block"], "upper");
    expect_refused({"check", "masonry.yaml", "--set", "geometry.blocks.2.polygon=[[0, 0.5], [1, 0.5], [1, 2], [0, 2]]"},
                   HasSubstr("'lower' and 'upper'"));
}

TEST_F(CommandLine, RunWithoutEquilibriumIsResumedWithTheSameVerdict) {
    write("masonry.yaml", masonry_scene);
    const Words words{"run", "masonry.yaml", "-o", "r", "--set", "stages.1.forces.push.force=[30 kN/m, 0]"};
    const Result first = kluft(words);
    EXPECT_EQ(first.code, 3);
    const auto before = summary("r");
    const std::string rows = content_of(path("r/history.csv"));
    const Result resumed = kluft(with(words, {"--resume"}));
    EXPECT_EQ(resumed.code, 3);
    for (const char* name : {"status", "message"}) EXPECT_EQ(summary("r")[name], before[name]) << name;
    EXPECT_EQ(summary("r")["falling_blocks"][0]["block"], "upper");
    EXPECT_EQ(content_of(path("r/history.csv")), rows);
}

TEST_F(CommandLine, ExplicitRunWritesTheSameFilesAndItsOwnQuality) {
    write("tiny.yaml", tiny_scene);
    const std::vector<std::string> words{"run", "tiny.yaml", "-o", "r", "--set", "analysis.integrator=explicit"};
    ASSERT_EQ(kluft(words).code, 0);
    expect_all_files(path("r"));
    EXPECT_EQ(summary("r")["integrator"], "explicit");
    EXPECT_GT(summary("r")["time_steps"], 100);
    EXPECT_LT(summary("r")["energy_error"], 0.01);
    EXPECT_THAT(content_of(path("r/history.csv")), HasSubstr("elapsed_s,time_steps,kinetic_ratio,platen_imbalance"));
    expect_refused(with(words, {"--resume"}), HasSubstr("--resume: expected analysis.integrator: implicit"));
}

TEST_F(CommandLine, ResumingIsRefusedWithoutASavedStateOrWithAnotherScene) {
    write("tiny.yaml", tiny_scene);
    expect_refused({"run", "tiny.yaml", "-o", "absent", "--resume"}, HasSubstr("absent/state.h5"));
    EXPECT_FALSE(fs::exists(path("absent")));
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r"}).code, 0);
    const std::string before = content_of(path("r/history.csv"));
    expect_refused({"run", "tiny.yaml", "-o", "r", "--resume", "--set", "stages.0.steps=3"},
                   HasSubstr("belongs to another scene"));
    EXPECT_EQ(content_of(path("r/history.csv")), before);
}

// What a run has warned of counts for all that goes on from it: an overloaded bond may have failed by then, and is seen no more.
TEST_F(CommandLine, ResumedRunKeepsTheWarningsOfTheRunsBeforeIt) {
    write("tiny.yaml", tiny_scene);
    const Words words{"run", "tiny.yaml", "-o", "r", "--set", "output.pictures=false"};
    ASSERT_EQ(kluft(words).code, 0);
    nlohmann::json told = summary("r");
    const std::size_t n = told["warnings"].size();
    told["warnings"].push_back("the bond of blocks 'a' and 'b' carries 1.35 times its strength");
    write("r/summary.json", told.dump());
    const Result resumed = kluft(with(words, {"--resume"}));
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_THAT(resumed.err, HasSubstr("warning: the bond of blocks 'a' and 'b'"));
    EXPECT_EQ(summary("r")["warnings"].size(), n + 1); // each once
    EXPECT_THAT(summary("r")["warnings"].dump(), HasSubstr("carries 1.35 times its strength"));
    fs::remove(path("r/summary.json"));
    EXPECT_THAT(kluft(with(words, {"--resume"})).err,
                HasSubstr("the run before this one has left no summary that can be read"));
}

// ---- out of disk and memory ----------------------------------------------------------------------------------------

// Files cannot grow beyond 6 kB, so that the history stops in the middle of the first stage.
TEST_F(CommandLine, FullDiskEndsWithExitCode4AndLeavesWholeRows) {
    const Words words = with(long_run, {"--set", "output.fields=false", "--set", "stages.0.steps=60"});
    const Result full = kluft(with(words, {"-o", "full"}), {.file_bytes = 6000});
    EXPECT_EQ(full.code, 4);
    EXPECT_THAT(full.err,
                HasSubstr(".csv: cannot write: File too large")); // which table depends on the digits of times
    EXPECT_THAT(content_of(path("full/run.log")), HasSubstr("cannot write: File too large"));
    EXPECT_EQ(summary("full")["status"], "out_of_resources");
    EXPECT_GT(summary("full")["factorizations"], 0);
    EXPECT_GT(summary("full")["steps"], 10);
    const auto rows = lines_of(content_of(path("full/history.csv")));
    const auto steps = summary("full")["steps"].get<std::size_t>();
    EXPECT_GE(rows.size(), 1U + steps); // head and initial state; the row of the last step may not fit
    EXPECT_LE(rows.size(), 2U + steps);
    for (const auto& row : rows) EXPECT_EQ(std::ranges::count(row, ','), 21) << row;
}

// The saved state grows with the cracks. Files cannot grow to its last size, so that saving it fails in the middle of the
// run; with room again the run goes on from the state before, to the same end.
TEST_F(SlowCommandLine, RunGoesOnAfterAFullDiskAndNothingIsLost) {
    const Words words = with(long_run, {"--set", "output.fields=false", "--set", "output.pictures=false", "--set",
                                        "output.checkpoint_every=5"});
    ASSERT_EQ(kluft(with(words, {"-o", "whole"})).code, 0);
    const rlim_t most = fs::file_size(path("whole/state.h5")) - 1;
    const Result full = kluft(with(words, {"-o", "full"}), {.file_bytes = most});
    EXPECT_EQ(full.code, 4);
    EXPECT_THAT(full.err, HasSubstr("state.h5.part: cannot write: File too large"));
    EXPECT_EQ(lines_of(full.err).size(), 1U) << full.err;
    EXPECT_FALSE(fs::exists(path("full/state.h5.part")));
    EXPECT_THAT(table("whole/history.csv"), StartsWith(table("full/history.csv")));
    const Result resumed = kluft(with(words, {"-o", "full", "--resume"}));
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    for (const char* name : {"history.csv", "equilibria.csv"})
        EXPECT_TRUE(table(std::string("full/") + name) == table(std::string("whole/") + name)) << name;
    EXPECT_TRUE(content_of(path("full/cracks.csv")) == content_of(path("whole/cracks.csv")));
}

TEST_F(CommandLine, PictureThatDoesNotFitLeavesNothing) {
    write("tiny.yaml", tiny_scene);
    const Result full = kluft({"draw", "tiny.yaml", "-o", "tiny.png"}, {.file_bytes = 1000});
    EXPECT_EQ(full.code, 4);
    EXPECT_THAT(full.err, HasSubstr("cannot write: File too large"));
    EXPECT_FALSE(fs::exists(path("tiny.png")));
    EXPECT_FALSE(fs::exists(path("tiny.png.part")));
}

// Old fields on a new body would be nobody's results.
TEST_F(CommandLine, ResultsWhoseMapHasChangedAreNeitherReportedNorExported) {
    const auto map = [](double end) {
        return R"({"type": "LineString", "coordinates": [[-1, 0.1], [1, )" + std::to_string(end) + "]]}";
    };
    write("map.geojson", map(0.3));
    write("tiny.yaml", std::regex_replace(tiny_scene, std::regex("\n  tessellation"),
                                          "\n  fractures: [{file: map.geojson, interface: joint}]\n  tessellation"));
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--quiet"}).code, 0);
    const std::string report = content_of(path("r/report.html"));
    EXPECT_EQ(kluft({"report", "r"}).code, 0);
    write("map.geojson", map(0.31));
    const auto changed = HasSubstr("a file of the geometry has changed since the run");
    expect_refused({"report", "r"}, changed);
    expect_refused({"draw", "r", "--step", "last", "-o", "r.png"}, changed);
    if (gdal_problem().empty()) expect_refused({"export", "r", "-o", "r.geojson"}, changed);
    EXPECT_EQ(content_of(path("r/report.html")), report);
    write("map.geojson", map(0.3));
    if (gdal_problem().empty())
        expect_refused({"export", "r", "-o", "map.geojson"}, HasSubstr("found one that the scene reads"));
}

TEST_F(CommandLine, AReportSaysWhereATableIsNotTheWholeOne) {
    write("tiny.yaml", tiny_scene);
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--quiet"}).code, 0);
    const std::string table = content_of(path("r/equilibria.csv"));
    for (const char* name : {"history.csv", "equilibria.csv"}) {
        const std::string whole = content_of(path(std::string("r/") + name));
        write(std::string("r/") + name, whole.substr(0, whole.find('\n', whole.size() / 2) + 1));
        ASSERT_EQ(kluft({"report", "r"}).code, 0);
        EXPECT_THAT(content_of(path("r/report.html")), HasSubstr("do not give the numbers of summary.json")) << name;
        write(std::string("r/") + name, whole);
    }
    ASSERT_EQ(kluft({"report", "r"}).code, 0);
    EXPECT_THAT(content_of(path("r/report.html")), Not(HasSubstr("do not give the numbers of summary.json")));
}

// A row that was cut off is left out, as a killed run leaves it; where the run has ended, that is said.
TEST_F(CommandLine, ReadersOfResultsSayWhereATableIsDamaged) {
    write("tiny.yaml", tiny_scene);
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--quiet"}).code, 0);
    const std::vector<Words> commands{{"report", "r"}, {"draw", "r"}, {"draw", "r", "--step", "last", "-o", "x.png"}};
    for (const char* name : {"history.csv", "equilibria.csv"}) {
        const std::string table = std::string("r/") + name;
        const std::string whole = content_of(path(table));
        const auto second_row = whole.find('\n', whole.find('\n') + 1) + 1;
        const auto third_row = whole.find('\n', second_row) + 1;
        for (const Words& command : commands) {
            write(table, whole.substr(0, second_row) + "no number" + whole.substr(second_row));
            expect_refused(command, StartsWith(table + ":3: step: expected an integer, found 'no number"));
            write(table, whole.substr(0, second_row) + "1,2\n" + whole.substr(third_row));
            expect_refused(command, StartsWith(table + ":3: expected 22 columns, found 2"));
            write(table, whole.substr(0, whole.size() - 20));
            const Result cut = kluft(command);
            EXPECT_EQ(cut.code, 0);
            EXPECT_THAT(cut.err,
                        HasSubstr(fmt::format("warning: r: {} ends at load step 9, summary.json says 10", name)));
            write(table, whole);
            EXPECT_THAT(kluft(command).err, Not(HasSubstr("ends at load step")));
        }
    }
}

/// A block on a plane of 20 degrees with a friction angle of 35: F = tan 35 / tan 20 = 1.924.
constexpr const char* sliding_block_scene = R"(kluft: 1
analysis: {gravity: 9.81}
materials:
  rock: {density: 2600 kg/m3, youngs_modulus: 20 GPa, poissons_ratio: 0.25}
interfaces:
  joint: {kind: fracture, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m, friction_angle: 35 deg}
geometry:
  domain: {polygon: [[0, 0], [10, 0], [10, 10], [0, 10]]}
  reference_spacing: 2 m
  fractures:
    - {name: plane, trace: [[-1, 3.636], [11, 8.003]], interface: joint}
boundaries:
  bottom: {support: fixed}
stages:
  - {name: weight, steps: 2}
  - {name: strength, strength_reduction: {to: 1.5}}
output: {fields: false, pictures: false}
)";

TEST_F(CommandLine, TheReportOfABodyThatStandsAtTheSmallestStrengthsHasThemAsABound) {
    write("slide.yaml", sliding_block_scene);
    ASSERT_EQ(kluft({"run", "slide.yaml", "-o", "r", "--quiet"}).code, 0);
    EXPECT_THAT(content_of(path("r/report.html")), HasSubstr("at least 1.5<"));
    EXPECT_EQ(kluft({"report", "r", "-o", "again.html"}).code, 0);
    EXPECT_THAT(content_of(path("again.html")), HasSubstr("at least 1.5<"));
    // Where it was left under half the weight nothing is known of the whole.
    const auto rows = lines_of(content_of(path("r/history.csv")));
    ASSERT_EQ(rows.size(), 5U);
    write("r/history.csv", rows[0] + '\n' + rows[1] + '\n' + rows[2] + '\n');
    EXPECT_EQ(kluft({"report", "r", "-o", "half.html"}).code, 0);
    EXPECT_THAT(content_of(path("half.html")), Not(HasSubstr("at least")));
}

// A block that slides on its plane is named as a whole where a net cuts it into cells, too: its share of the body is that above the trace,
// from 4 m on the left to 7.64 m on the right of 10 m: 1 - 0.582 = 0.418.
TEST_F(CommandLine, ANettedBlockThatSlidesIsNamedAsAWhole) {
    write("slide.yaml", sliding_block_scene);
    ASSERT_EQ(
        kluft({"run", "slide.yaml", "-o", "r", "--quiet", "--set", "stages.1.strength_reduction.to=3", "--set",
               "interfaces.bond={kind: potential_crack, fails_to: joint}", "--set", "materials.rock.cohesion=5 MPa",
               "--set", "materials.rock.friction_angle=40", "--set", "materials.rock.tensile_strength=2 MPa", "--set",
               "geometry.tessellation={triangles: {spacing: 2 m}, interface: bond}"})
            .code,
        0);
    double share = 0.0;
    const auto json = summary("r");
    for (const auto& each : json["falling_blocks"]) share += each["share_of_body"].get<double>();
    EXPECT_NEAR(json["factor_of_safety"].get<double>(), 1.92, 0.01);
    EXPECT_NEAR(share, 0.418, 0.002);
}

// A sliding block (20 deg, joint 35 deg: tan 35/tan 20 = 1.92): the picture drawn later is the run's, with the arrow of what slides and the factor.
TEST_F(CommandLine, DrawMakesThePictureOfAFactorOfSafetyAgain) {
    write("slide.yaml", sliding_block_scene);
    ASSERT_EQ(kluft({"run", "slide.yaml", "-o", "r", "--quiet", "--set", "stages.1.strength_reduction.to=3", "--set",
                     "output.pictures=true"})
                  .code,
              0);
    const std::string of_run = content_of(path("r/blocks.svg"));
    EXPECT_THAT(of_run, AllOf(HasSubstr("after, factor of safety 1.92"), HasSubstr("moves on beyond this state")));
    EXPECT_EQ(kluft({"draw", "r"}).code, 0);
    EXPECT_EQ(content_of(path("r/blocks.svg")), of_run);
}

TEST_F(CommandLine, AFileInADirectoryThatIsNotThereIsRefused) {
    write("tiny.yaml", tiny_scene);
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--quiet"}).code, 0);
    expect_refused({"draw", "r", "--step", "last", "-o", "absent/x.png"},
                   HasSubstr("expected a file in a directory that is there"));
    if (gdal_problem().empty())
        expect_refused({"export", "r", "-o", "absent/x.gpkg"},
                       HasSubstr("expected a file in a directory that is there"));
}

TEST_F(CommandLine, FilesOfTheUsersOwnAreNotReplaced) {
    write("tiny.yaml", tiny_scene);
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--quiet"}).code, 0);
    std::vector<std::pair<std::string, Words>> files{{"mine.html", {"report", "r", "-o", "mine.html"}}};
    for (const char* const picture : {"mine.png", "mine.svg", "mine.pdf"})
        files.push_back({picture, {"draw", "tiny.yaml", "-o", picture}});
    if (gdal_problem().empty())
        for (const char* const map : {"mine.gpkg", "mine.geojson"}) files.push_back({map, {"export", "r", "-o", map}});
    for (const auto& [file, command] : files) {
        write(file, "mine");
        expect_refused(command, AllOf(HasSubstr(file), HasSubstr("which would be lost")));
        EXPECT_EQ(content_of(path(file)), "mine");
        write(file, ""); // as mktemp makes it
        EXPECT_EQ(kluft(command).code, 0) << file;
        EXPECT_EQ(kluft(command).code, 0) << file << ": its own gives way";
        fs::remove(path(file));
        fs::create_directory(path(file));
        expect_refused(command, HasSubstr("found a directory"));
        fs::remove(path(file));
        ASSERT_EQ(mkfifo(path(file).c_str(), 0600), 0);
        expect_refused(command, HasSubstr("found a pipe"));
    }
}

TEST_F(CommandLine, ARunIsExportedAsAMapInTheSystemOfItsScene) {
    write("tiny.yaml", std::regex_replace(tiny_scene, std::regex("domain: \\{rectangle: \\{"),
                                          "crs: EPSG:25832\n  domain: {rectangle: {origin: [691400, 5334600], "));
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--quiet"}).code, 0);
    if (!gdal_problem().empty()) return expect_refused({"export", "r"}, HasSubstr("GDAL"));
    const Result exported = kluft({"export", "r", "-o", "r.geojson", "--step", "peak"});
    ASSERT_EQ(exported.code, 0) << exported.err;
    EXPECT_EQ(exported.out, "r.geojson\n");
    const auto map = nlohmann::json::parse(content_of(path("r.geojson")));
    EXPECT_EQ(map["crs"]["properties"]["name"], "urn:ogc:def:crs:EPSG::25832");
    double area = 0.0;
    for (const auto& feature : map["features"]) {
        if (feature["properties"]["layer"] != "blocks") continue;
        const auto ring = feature["geometry"]["coordinates"][0].get<std::vector<std::array<double, 2>>>();
        for (std::size_t i = 0; i + 1 < ring.size(); ++i)
            area += 0.5 * ((ring[i][0] - 691400.0) * (ring[i + 1][1] - 5334600.0) -
                           (ring[i + 1][0] - 691400.0) * (ring[i][1] - 5334600.0));
    }
    EXPECT_NEAR(area, 0.2 * 0.4, 1e-7); // of the domain; ordinates have 1e-9 m
    EXPECT_EQ(kluft({"export", "r"}).code, 0);
    EXPECT_TRUE(fs::exists(path("r.gpkg")));
    write("plain.yaml", tiny_scene);
    ASSERT_EQ(kluft({"run", "plain.yaml", "-o", "p", "--quiet"}).code, 0);
    ASSERT_EQ(kluft({"export", "p"}).code, 0);
    EXPECT_THAT(content_of(path("p.gpkg")),
                HasSubstr("Undefined Cartesian SRS")); // lengths: nothing says that they are degrees
    expect_refused({"export", "r", "-o", "r.shp"},
                   HasSubstr("expected a file that ends in .gpkg or .geojson, found r.shp"));
    expect_refused({"export", "tiny.yaml"}, HasSubstr("expected a directory of results"));
    const Result full = kluft({"export", "r", "-o", "full.gpkg"}, {.file_bytes = 1000});
    EXPECT_EQ(full.code, 4);
    EXPECT_FALSE(fs::exists(path("full.gpkg")));
    EXPECT_FALSE(fs::exists(path("full.gpkg.part")));
}

// Only the pictures, the last that is written, do not fit.
TEST_F(CommandLine, SummaryOfARunWithoutRoomForItsPicturesSaysSo) {
    const Words words =
        with(long_run, {"-o", "r", "--set", "stages.1.strain.value=0.05 %", "--set", "output.fields=false"});
    ASSERT_EQ(kluft(words).code, 0);
    const rlim_t state = fs::file_size(path("r/state.h5"));
    ASSERT_LT(state + 1000, fs::file_size(path("r/blocks.png")));
    const Result full = kluft(words, {.file_bytes = state + 1000});
    EXPECT_EQ(full.code, 4);
    EXPECT_THAT(full.err, HasSubstr("cannot write: File too large"));
    EXPECT_EQ(summary("r")["status"], "out_of_resources");
    EXPECT_THAT(summary("r")["message"].get<std::string>(), HasSubstr("cannot write: File too large"));
    EXPECT_EQ(kluft(with(words, {"--resume"})).code, 0);
    EXPECT_EQ(summary("r")["status"], "done");
}

// ---- standard output -----------------------------------------------------------------------------------------------

/// Commands that say something, by what they say it about.
std::vector<Words> saying_commands() {
    return {{"check", "tiny.yaml"},
            {"run", "tiny.yaml", "-o", "again", "--set", "stages.1.steps=2"},
            {"draw", "tiny.yaml", "-o", "tiny.png"},
            {"compare", "r", "r"},
            {"envelope", "table.csv"},
            {"study", "study.yaml", "--emit", "make"},
            {"--help"},
            {"--version"}};
}

class StandardOutput : public CommandLine {
protected:
    StandardOutput() {
        write("tiny.yaml", tiny_scene);
        write("study.yaml", "scene: tiny.yaml\nvary: {stages.1.steps: [4]}\n");
        write("table.csv", "sigma_3,sigma_1\n0,1e6\n1e6,5e6\n2e6,9e6\n");
        EXPECT_EQ(kluft({"run", "tiny.yaml", "-o", "r"}).code, 0);
    }
};

TEST_F(StandardOutput, ThatDoesNotFitIsExitCode4) {
    for (const Words& words : saying_commands()) {
        const Result full = kluft(words, {.reader = Reader::no_room});
        EXPECT_EQ(full.code, 4) << words[0];
        EXPECT_THAT(full.err, HasSubstr("standard output: cannot write: No space left on device")) << words[0];
    }
    EXPECT_EQ(summary("again")["status"], "out_of_resources");
    EXPECT_EQ(lines_of(content_of(path("again/history.csv"))).size(), 6U);
}

TEST_F(StandardOutput, ThatNobodyReadsDoesNotMatter) {
    for (const Words& words : saying_commands())
        EXPECT_EQ(kluft(words, {.reader = Reader::nobody}).code, 0) << words[0];
    EXPECT_EQ(summary("again")["status"], "done");
    expect_all_files(path("again"));
}

// The next file that is opened would get the number of a closed stream, and what is said with it.
TEST_F(StandardOutput, ThatIsClosedIsNotTakenForATable) {
    for (const Words& words : saying_commands())
        EXPECT_EQ(kluft(words, {.reader = Reader::closed}).code, 0) << words[0];
    const std::string history = content_of(path("again/history.csv"));
    EXPECT_EQ(lines_of(history).size(), 6U);
    for (const char* name : {"history.csv", "equilibria.csv", "cracks.csv", "jumps.csv"})
        EXPECT_THAT(content_of(path(std::string("again/") + name)), Not(HasSubstr("stage 1  step"))) << name;
}

TEST_F(SlowCommandLine, OutOfMemoryEndsWithExitCode4) {
#ifdef KLUFT_SANITIZED
    GTEST_SKIP() << "the address sanitizer reserves more address space than any limit";
#endif
    constexpr rlim_t megabyte = 1000000;
    rlim_t enough = 64 * megabyte; // to load the program
    while (enough < 4000 * megabyte && kluft({"--version"}, {.memory_bytes = enough}).code != 0)
        enough += 16 * megabyte;
    const Result result = kluft({"run", model("quickstart.yaml"), "-o", "r", "--set", "output.pictures=false", "--set",
                                 "geometry.tessellation.triangles.spacing=0.003"},
                                {.memory_bytes = enough + 16 * megabyte});
    EXPECT_EQ(result.code, 4);
    EXPECT_THAT(result.err, HasSubstr("out of memory"));
}

TEST_F(SlowCommandLine, GdalThatTheMemoryDoesNotHoldEndsWithExitCode4) {
#ifdef KLUFT_SANITIZED
    GTEST_SKIP() << "the address sanitizer reserves more address space than any limit";
#endif
    if (!gdal_problem().empty()) GTEST_SKIP() << gdal_problem();
    write("tiny.yaml", tiny_scene);
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--quiet"}).code, 0);
    constexpr rlim_t megabyte = 1000000;
    int n_without_room = 0;
    for (rlim_t room = 64 * megabyte; room < 4000 * megabyte; room += 16 * megabyte) {
        const Result result = kluft({"export", "r", "-o", "r.gpkg"}, {.memory_bytes = room});
        if (result.code == 0) break;
        if (result.err.find("GDAL") == std::string::npos) continue; // too little for the program itself
        EXPECT_EQ(result.code, 4) << result.err;
        EXPECT_THAT(result.err, StartsWith("out of memory: GDAL cannot be loaded"));
        ++n_without_room;
    }
    EXPECT_GE(n_without_room, 2);
}

// The BLAS tries for ever to get its work space of 128 MB where the system refuses it: also in a second start with other
// kernels, which are tried before anything else.
TEST_F(SlowCommandLine, SecondStartWithoutRoomForTheBlasEndsWithExitCode4) {
#ifdef KLUFT_SANITIZED
    GTEST_SKIP() << "the address sanitizer reserves more address space than any limit";
#endif
    constexpr rlim_t megabyte = 1000000;
    const std::map<std::string, std::string> second_start{{"OPENBLAS_CORETYPE", "Prescott"},
                                                          {"KLUFT_OWN_BLAS_CORE", "Prescott"}};
    int n_without_room = 0;
    for (rlim_t room = 64 * megabyte; room < 4000 * megabyte; room += 16 * megabyte) {
        const Result result = kluft({"--version"}, {.memory_bytes = room, .environment = second_start});
        if (result.code == 0) break;
        if (result.code == 4) ++n_without_room; // else too little to load the libraries
    }
    EXPECT_GE(n_without_room, 4); // 128 MB
}

// A thread of 2 GB in an address space of 1 GB. The BLAS starts it before the program begins, and interrupts the program where it cannot.
TEST_F(CommandLine, NoRoomForTheThreadsOfTheBlasEndsWithExitCode4) {
#ifdef KLUFT_SANITIZED
    GTEST_SKIP() << "the address sanitizer reserves more address space than any limit";
#endif
    if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "the BLAS starts no thread on one processor";
    constexpr rlim_t gigabyte = 1000000000;
    const Result result =
        kluft({"--version"},
              {.memory_bytes = gigabyte, .environment = {{"OPENBLAS_NUM_THREADS", "2"}}, .stack_bytes = 2 * gigabyte});
    EXPECT_EQ(result.code, 4);
    EXPECT_THAT(result.err, HasSubstr("out of memory: no room for the threads of the BLAS\n"));
}

// The BLAS's thread tries for ever to get a work space of 128 MB where the system refuses it, and OpenBLAS waits for the thread
// before it starts another process: with the least address space in which the program says its version there is no room for it.
// The same study, where there is room, goes on with the cases that failed.
TEST_F(SlowCommandLine, StudyWithoutRoomForTheBlasEndsWithExitCode4AndGoesOnLater) {
#ifdef KLUFT_SANITIZED
    GTEST_SKIP() << "the address sanitizer reserves more address space than any limit";
#endif
    write("tiny.yaml", tiny_scene);
    write("study.yaml", "scene: tiny.yaml\nvary: {stages.1.steps: [4, 8]}\n");
    constexpr rlim_t megabyte = 1000000;
    Limits limits{.memory_bytes = 64 * megabyte, .environment = {{"OPENBLAS_NUM_THREADS", "2"}}};
    while (limits.memory_bytes < 4000 * megabyte && kluft({"--version"}, limits).code != 0)
        limits.memory_bytes += 16 * megabyte;
    limits.memory_bytes += 16 * megabyte;
    const Words study{"study", "study.yaml", "-o", "s", "--jobs", "1", "--quiet"};
    const Result result = kluft(study, limits);
    EXPECT_EQ(result.code, 4);
    EXPECT_THAT(result.err, HasSubstr("failed: out of disk or memory: out of memory: no address space for the work"));
    EXPECT_THAT(result.out, StartsWith("2 cases: 0 done, 2 failed"));
    EXPECT_EQ(kluft(with(study, {"--collect"})).code, 4);
    EXPECT_EQ(kluft(study).code, 0);
}

/// The program does not start itself again with another count of allocations.
const std::map<std::string, std::string> one_kernel{{"OPENBLAS_CORETYPE", "Haswell"}};

/// A program in which allocations fail (tests/support/failing_memory.c).
Limits failing(std::map<std::string, std::string> how) {
    how["LD_PRELOAD"] = KLUFT_FAILING_MEMORY;
    how.insert(one_kernel.begin(), one_kernel.end());
    return {.environment = std::move(how)};
}

// Allocations all over a run fail, one or all from there on. Either the run ends as it would have, or it says why it ends,
// leaves whole files, and goes on to the same end.
TEST_F(SlowCommandLine, RunSurvivesAllocationsThatFailAndNothingIsLost) {
#ifdef KLUFT_SANITIZED
    GTEST_SKIP() << "the address sanitizer has an allocator of its own";
#endif
    write("tiny.yaml", tiny_scene);
    const Words words{"run",
                      "tiny.yaml",
                      "--quiet",
                      "--set",
                      "solver.repeatable=true",
                      "--set",
                      "output.fields_every=2",
                      "--set",
                      "stages.1.strain.value=0.25 %"};
    ASSERT_EQ(kluft(with(words, {"-o", "whole"}), failing({{"KLUFT_FAIL_COUNT", path("count")}})).code, 0);
    const int n = std::stoi(content_of(path("count")));
    ASSERT_GT(n, 10000);
    int n_cut_short = 0;
    for (int i = 0; i < 12; ++i) {
        const int at = 1 + static_cast<int>((n - 1LL) * i / 11);
        const std::string run = "r" + std::to_string(at);
        const Result result =
            kluft(with(words, {"-o", run}),
                  failing({{"KLUFT_FAIL_AT", std::to_string(at)}, {"KLUFT_FAIL_FOR", i % 2 == 0 ? "0" : "1"}}));
        SCOPED_TRACE(run + ": " + result.err);
        for (const auto& file : fs::recursive_directory_iterator(directory_.path()))
            EXPECT_NE(file.path().extension(), ".part");
        if (result.code != 0) {
            ASSERT_EQ(result.code, 4);
            EXPECT_EQ(result.err, "out of memory\n");
            ++n_cut_short;
            if (!fs::exists(path(run))) continue; // in what stands before the first load step
            EXPECT_THAT(summary(run)["status"], AnyOf("out_of_resources", "done")); // done: only pictures are missing
            ASSERT_EQ(kluft(with(words, {"-o", run, "--resume"}), {.environment = one_kernel}).code, 0);
        }
        EXPECT_EQ(table(run + "/history.csv"), table("whole/history.csv"));
        EXPECT_EQ(content_of(path(run + "/cracks.csv")), content_of(path("whole/cracks.csv")));
    }
    EXPECT_GT(n_cut_short, 3);
}

// ---- memory --------------------------------------------------------------------------------------------------------

// Bonded hexagons, cut by fractures or not, in four load steps.
const char* const hexagon_scene = R"(kluft: 1
materials:
  rock: {density: 2300, youngs_modulus: 1500 MPa, poissons_ratio: 0.25, cohesion: 10 MPa, friction_angle: 40, tensile_strength: 5 MPa}
interfaces:
  joint: {kind: fracture, normal_stiffness_times_spacing: 200 MPa, shear_stiffness_times_spacing: 100 MPa, friction_angle: 12}
  bond: {kind: potential_crack, normal_stiffness_times_spacing: 200 MPa, shear_stiffness_times_spacing: 100 MPa, fails_to: joint}
geometry:
  domain: {rectangle: {width: 1.0, height: 1.0}}
  tessellation: {hexagons: {spacing: 0.05}, interface: bond}
boundaries: {bottom: {support: smooth}}
stages:
  - {name: pressure, pressure: {left: 0.2 MPa, right: 0.2 MPa, top: 0.2 MPa}, steps: 1}
  - {name: platen, strain: {boundary: top, value: 0.1 %}, steps: 3}
)";

const char* const fractured_hexagons = R"(extends: whole.yaml
geometry:
  fractures: [{trace: [[-0.1, 0.2], [1.1, 0.8]], interface: joint}, {trace: [[0.35, -0.1], [0.55, 1.1]], interface: joint}]
)";

double megabytes_in(const std::string& out) {
    std::smatch found;
    return std::regex_search(out, found, std::regex("memory +about ([^ ]+) MB")) ? std::stod(found[1]) : 0.0;
}

// The estimate against the largest resident memory of the run, by the kernel's count: within 20 % for 500 and 2000
// blocks, affine and rigid, whole, with fractures, or of fractures alone, with pictures and without; of 8000 rigid blocks too,
// of which the program itself is a small part, and of 5100 affine ones, whose factor is made in single precision.
TEST_F(SlowCommandLine, CheckEstimatesTheLargestMemoryOfARun) {
#ifdef KLUFT_SANITIZED
    GTEST_SKIP() << "sanitizers multiply the memory";
#endif
    write("whole.yaml", hexagon_scene);
    write("fractured.yaml", fractured_hexagons);
    const auto expect_estimate = [&](const Words& scene) {
        const double estimate = megabytes_in(kluft(with({"check"}, scene)).out);
        ASSERT_EQ(kluft(with(with({"run"}, scene), {"-o", "r", "--quiet", "--force"})).code, 0);
        const double peak = 1e-6 * summary("r")["peak_memory_bytes"].get<double>();
        EXPECT_NEAR(estimate, peak, 0.2 * peak) << ::testing::PrintToString(scene);
    };
    const Words without_pictures{"--set", "output.pictures=false"};
    const Words fine{"--set", "geometry.tessellation.hexagons.spacing=0.0243"};
    const Words loose{"--set", "geometry.tessellation.interface=joint"};
    const Words rigid{"--set", "analysis.kinematics=rigid"};
    const Words finer{"--set", "geometry.tessellation.hexagons.spacing=0.0122"};
    expect_estimate({"whole.yaml"});
    for (const Words& scene : {Words{"whole.yaml"}, Words{"fractured.yaml"}, with({"whole.yaml"}, loose)}) {
        expect_estimate(with(scene, without_pictures));
        expect_estimate(with(with(scene, fine), without_pictures));
        expect_estimate(with(with(scene, rigid), without_pictures));
        expect_estimate(with(with(scene, rigid), fine));
    }
    expect_estimate(with({"fractured.yaml"}, fine));
    expect_estimate(with(with({"whole.yaml"}, rigid), finer));
    const Words large{"--set", "geometry.tessellation.hexagons.spacing=0.0152"};
    expect_estimate(with(with({"whole.yaml"}, large), without_pictures));
}

// ---- determinism ---------------------------------------------------------------------------------------------------

TEST_F(SlowCommandLine, SameSceneGivesTheSameTablesWithAnyNumberOfThreads) {
    ASSERT_EQ(kluft(with(long_run, {"-o", "first"})).code, 0);
    ASSERT_EQ(kluft(with(long_run, {"-o", "again"})).code, 0);
    ASSERT_EQ(kluft(with(long_run, {"-o", "two", "--threads", "2"})).code, 0);
    for (const char* name : {"history.csv", "equilibria.csv"}) {
        EXPECT_TRUE(table(std::string("again/") + name) == table(std::string("first/") + name)) << name;
        EXPECT_TRUE(table(std::string("two/") + name) == table(std::string("first/") + name)) << name;
    }
    EXPECT_TRUE(content_of(path("two/cracks.csv")) == content_of(path("first/cracks.csv")));
    EXPECT_GT(lines_of(content_of(path("first/cracks.csv"))).size(), 1U);
}

// ---- kluft draw, kluft compare, kluft envelope ------------------------------------------------------------------------------------

TEST_F(CommandLine, DrawMakesPicturesOfScenesAndRuns) {
    write("tiny.yaml", tiny_scene);
    EXPECT_EQ(kluft({"draw", "tiny.yaml"}).code, 0);
    EXPECT_THAT(content_of(path("tiny.png")), StartsWith("\x89PNG"));
    EXPECT_EQ(kluft({"draw", "tiny.yaml", "-o", "tiny.svg"}).code, 0);
    EXPECT_THAT(content_of(path("tiny.svg")), HasSubstr("</svg>"));
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--set", "output.pictures=false"}).code, 0);
    EXPECT_EQ(kluft({"draw", "r"}).code, 0);
    for (const char* name : {"r/curve.png", "r/curve.svg", "r/blocks.png", "r/blocks.svg"})
        EXPECT_GT(fs::file_size(path(name)), 0U) << name;
    EXPECT_EQ(kluft({"draw", "r", "r", "-o", "both.svg", "--mark", "published=0.3 MPa"}).code, 0);
    EXPECT_THAT(content_of(path("both.svg")), HasSubstr("</svg>"));
}

TEST_F(CommandLine, PicturesAndMapsThatNobodyNamedReplaceTheirLikeOnly) {
    write("tiny.yaml", tiny_scene);
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--quiet", "--set", "output.pictures=false"}).code, 0);
    std::vector<std::pair<std::string, Words>> files{{"tiny.png", {"draw", "tiny.yaml"}},
                                                     {"curves.png", {"draw", "r", "r"}},
                                                     {"r-sigma_1-0.png", {"draw", "r", "--step", "0"}}};
    if (gdal_problem().empty()) files.push_back({"r.gpkg", {"export", "r"}});
    for (const auto& [name, words] : files) {
        write(name, "mine");
        expect_refused(words,
                       AllOf(StartsWith(name + ": expected a "), HasSubstr("would be lost; choose a name with -o")));
        EXPECT_EQ(content_of(path(name)), "mine");
        fs::remove(path(name));
        EXPECT_EQ(kluft(with(words, {"-o", name})).code, 0);
        for (int i = 0; i < 2; ++i) EXPECT_EQ(kluft(words).code, 0) << name;
    }
}

TEST_F(CommandLine, DrawMakesAPictureOfAKeptStateByAField) {
    write("tiny.yaml", tiny_scene);
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--set", "output.pictures=false"}).code, 0);
    EXPECT_EQ(kluft({"draw", "r", "--step", "0", "--field", "displacement", "-o", "first.png"}).code, 0);
    EXPECT_THAT(content_of(path("first.png")), StartsWith("\x89PNG"));
    EXPECT_EQ(
        kluft({"draw", "r", "--step", "peak", "--scale", "20", "--window", "0,0,5 cm,0.05", "-o", "peak.pdf"}).code, 0);
    EXPECT_THAT(content_of(path("peak.pdf")), StartsWith("%PDF"));
    const Result last = kluft({"draw", "r", "--field", "sigma_3"});
    EXPECT_EQ(last.code, 0);
    EXPECT_THAT(last.out, HasSubstr("r-sigma_3-"));
    expect_refused({"draw", "r", "--step", "1"},
                   HasSubstr("--step: expected a load step whose fields are kept, the nearest"));
    expect_refused({"draw", "r", "--step", "peek"}, HasSubstr("did you mean 'peak'?"));
    expect_refused({"draw", "r", "--field", "sigma1"}, HasSubstr("did you mean 'sigma_1'?"));
    expect_refused({"draw", "r", "--scale", "big"}, HasSubstr("--scale: expected a number >= 0, found 'big'"));
    for (const char* window : {"0,0,1", "1,0,0,1", "a,0,1,1", "0,0,1,1,"})
        expect_refused({"draw", "r", "--window", window}, HasSubstr("--window: expected x0,y0,x1,y1"));
    expect_refused({"draw", "r", "--window", "50,50,60,60"}, HasSubstr("--window: expected a part of the body"));
    for (const char* window : {"--window=-1e308,-1e308,1e308,1e308", "--window=0,0,1e10,1e10", "--window=0,0,1e-13,1"})
        expect_refused({"draw", "r", window, "-o", "wide.svg"}, HasSubstr("--window: expected coordinates up to "));
    expect_refused({"draw", "tiny.yaml", "--step", "last"},
                   HasSubstr("expected one directory of results, found a scene file"));
    expect_refused({"draw", "r", "--curve", "--step", "last"}, HasSubstr("found one of a curve"));
}

TEST_F(CommandLine, ReportIsWrittenByARunUnlessTheSceneSaysNotAndByItsOwnCommand) {
    write("tiny.yaml", tiny_scene);
    const Words run{"run", "tiny.yaml", "--quiet", "--set", "output.pictures=false", "-o"};
    ASSERT_EQ(kluft(with(run, {"r"})).code, 0);
    const std::string page = content_of(path("r/report.html"));
    EXPECT_THAT(page, AllOf(StartsWith("<!DOCTYPE html>"), HasSubstr("aria-label=\"Answer\""), HasSubstr("</html>")));
    EXPECT_THAT(page, Not(ContainsRegex("(src|href)=\"[^#d]"))) << "needs another file";
    ASSERT_EQ(kluft(with(run, {"without", "--set", "output.report=false"})).code, 0);
    EXPECT_FALSE(fs::exists(path("without/report.html")));
    const Result result = kluft({"report", "without"});
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(result.out, "without/report.html\n");
    EXPECT_TRUE(fs::exists(path("without/report.html")));
    const Result named = kluft({"report", "without", "-o", "page.html"});
    EXPECT_EQ(named.out, "page.html\n") << named.err;
    EXPECT_THAT(content_of(path("page.html")), HasSubstr("aria-label=\"Answer\""));
    expect_refused({"report", "without", "-o", "page.txt"}, HasSubstr("--output: expected a name that ends in .html"));
    expect_refused({"report", "without", "r", "-o", "page.html"},
                   HasSubstr("expected one directory of results beside it"));
}

TEST_F(CommandLine, ReportRefusesWhatIsNoRunAndDamagedFiles) {
    write("tiny.yaml", tiny_scene);
    fs::create_directory(path("empty"));
    expect_refused({"report", "absent"}, HasSubstr("absent: expected a directory of results, found nothing"));
    expect_refused({"report", "tiny.yaml"}, HasSubstr("tiny.yaml: expected a directory of results, found a file"));
    expect_refused({"report", "empty"}, HasSubstr("empty: expected a directory of results, found no history.csv"));
    ASSERT_EQ(kluft({"run", "tiny.yaml", "--quiet", "-o", "r", "--set", "output.report=false"}).code, 0);
    const auto refused_with = [&](const std::string& name, const std::string& content, const std::string& message) {
        const std::string before = content_of(path("r/" + name));
        write("r/" + name, content);
        expect_refused({"report", "r"}, HasSubstr(message));
        EXPECT_FALSE(fs::exists(path("r/report.html"))) << name;
        write("r/" + name, before);
    };
    refused_with("history.csv", "step,stage\n", "r/history.csv");
    refused_with("summary.json", "{", "r/summary.json");
    refused_with("state.h5", "no state", "r/state.h5");
    refused_with("fields/blocks_000000.vtu", "<VTKFile/>", "r/fields/blocks_000000.vtu: expected a field file");
    EXPECT_EQ(kluft({"report", "r"}).code, 0);
}

// What it has computed is whole without it.
TEST_F(CommandLine, AResumedRunEndsBesideADamagedFieldFile) {
    write("tiny.yaml", tiny_scene);
    const Words run{"run", "tiny.yaml", "-o", "r"};
    ASSERT_EQ(kluft(with(run, {"--quiet"})).code, 0);
    write("r/fields/blocks_000000.vtu", content_of(path("r/fields/blocks_000000.vtu")).substr(0, 2000));
    const Result resumed = kluft(with(run, {"--resume"}));
    EXPECT_EQ(resumed.code, 0) << resumed.err;
    const std::string warning = "the report is without load step 0: r/fields/blocks_000000.vtu: expected ";
    EXPECT_THAT(resumed.err, HasSubstr("warning: " + warning));
    EXPECT_THAT(content_of(path("r/report.html")), AllOf(HasSubstr("<li>" + warning), HasSubstr("id=\"state-0\"")));
    EXPECT_THAT(content_of(path("r/run.log")), HasSubstr(warning));
    expect_refused({"report", "r"}, HasSubstr("r/fields/blocks_000000.vtu: expected "));
}

TEST_F(CommandLine, DrawRefusesWhatItCannotDraw) {
    write("tiny.yaml", tiny_scene);
    fs::create_directory(path("empty"));
    expect_refused({"draw", "absent"}, HasSubstr("absent: expected a scene file or a directory of results"));
    expect_refused({"draw", "empty"}, HasSubstr("empty: expected a directory of results, found no history.csv"));
    expect_refused({"draw", "tiny.yaml", "-o", "tiny.gif"}, HasSubstr(".png"));
    expect_refused({"draw", "tiny.yaml", "empty"}, HasSubstr("tiny.yaml: expected a directory of results"));
    EXPECT_FALSE(fs::exists(path("tiny.gif")));
}

// A run that was killed before its first state leaves its scene and tables without rows.
TEST_F(CommandLine, RunThatHasSavedNoStateYetIsSaidToBeOne) {
    write("tiny.yaml", tiny_scene);
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--quiet", "--set", "output.pictures=false"}).code, 0);
    fs::create_directory(path("killed"));
    fs::copy(path("r/scene.yaml"), path("killed/scene.yaml"));
    write("killed/history.csv", lines_of(content_of(path("r/history.csv"))).front() + "\n");
    for (const Words& words :
         {Words{"draw", "killed", "--step", "last"}, Words{"draw", "killed", "--blocks"}, Words{"draw", "killed"},
          Words{"report", "killed"}, Words{"export", "killed", "-o", "x.geojson"}}) {
        if (words[0] == "export" && !gdal_problem().empty()) continue;
        expect_refused(words,
                       StartsWith("killed: expected a run that has saved a state, found one that has saved none yet"));
    }
}

TEST_F(CommandLine, DrawNamesTheOptionThatDoesNotFitThePicture) {
    write("tiny.yaml", tiny_scene);
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--quiet", "--set", "output.pictures=false"}).code, 0);
    expect_refused({"draw", "r", "--scale", "1e300", "--step", "last", "-o", "z.png"},
                   StartsWith("--scale: expected at most 1e+09, found '1e300'"));
    const auto no_curve = HasSubstr("--limit and --mark: expected a picture of a curve");
    expect_refused({"draw", "r", "--limit", "-5 MPa", "-o", "z.png"}, no_curve);
    expect_refused({"draw", "r", "--limit", "5 MPa", "--blocks"}, no_curve);
    expect_refused({"draw", "r", "--mark", "published=1 MPa", "--blocks"}, no_curve);
    expect_refused({"draw", "r", "--limit", "5 MPa", "--step", "last"}, HasSubstr("found one of a curve"));
    expect_refused({"draw", "tiny.yaml", "--limit", "5 MPa"}, HasSubstr("expected a directory of results"));
    expect_refused({"draw", "r", "--limit", "0", "--curve"}, HasSubstr("--limit: expected a stress above 0"));
    expect_refused({"draw", "r", "--limit", "5 m", "--curve"}, HasSubstr("found '5 m', which is in m\n"));
    expect_refused({"draw", "r", "--mark", "nope:x=1 MPa", "--curve"},
                   AllOf(StartsWith("--mark 'nope:x=1 MPa': "), HasSubstr("found 'nope' where the runs are r")));
    for (const char* mark : {"r:x=1 MPa", "test 3: peak=1 MPa"})
        EXPECT_EQ(kluft({"draw", "r", "--mark", mark, "--curve", "--limit", "2 MPa"}).code, 0) << mark;
}

TEST_F(CommandLine, DirectoryThatTheSystemDoesNotMakeIsBadInput) {
    write("tiny.yaml", tiny_scene);
    for (const char* directory : {"/proc/x", "/sys/x", "/dev/null/x"}) {
        if (fs::path(directory).parent_path() == "/sys" && is_read_only("/sys")) continue; // below
        expect_refused({"run", "tiny.yaml", "-o", directory}, HasSubstr(directory));
    }
}

TEST_F(CommandLine, NewResultsInAReadOnlyDirectoryEndWithExitCode4AndTheCause) {
    write("tiny.yaml", tiny_scene);
    const bool has_file_system = is_read_only("/sys"); // as in containers
    fs::create_directory(path("kept"));
    fs::permissions(path("kept"), fs::perms::owner_read | fs::perms::owner_exec);
    if (!has_file_system && geteuid() == 0) GTEST_SKIP() << "no directory here is read-only for root";
    const std::string place = has_file_system ? "/sys" : path("kept").string();
    const std::string cause = has_file_system ? "Read-only file system" : "Permission denied";
    for (const Words& words : {Words{"run", "tiny.yaml", "-o", place + "/new/er"},
                               Words{"study", "step-size", "tiny.yaml", "-o", place + "/new"},
                               Words{"draw", "tiny.yaml", "-o", place + "/new.png"}}) {
        const Result result = kluft(words);
        EXPECT_EQ(result.code, 4) << words[0];
        EXPECT_EQ(result.err, fmt::format("{}: cannot write in {}: {}\n", words.back(), place, cause));
    }
}

TEST_F(CommandLine, CompareSetsTwoRunsSideBySide) {
    write("tiny.yaml", tiny_scene);
    const Words run{"run", "tiny.yaml", "--quiet", "--set", "output.pictures=false", "-o"};
    ASSERT_EQ(kluft(with(run, {"event"})).code, 0);
    ASSERT_EQ(kluft(with(run, {"all", "--set", "cracks.update=all"})).code, 0);
    ASSERT_EQ(kluft(with(run, {"explicit", "--set", "analysis.integrator=explicit"})).code, 0);

    const Result same = kluft({"compare", "event", "event", "--tolerance", "0"});
    EXPECT_EQ(same.code, 0) << same.out;
    EXPECT_THAT(same.out, HasSubstr("The runs agree within 0 %."));
    EXPECT_TRUE(fs::exists(path("results/compare-event-event/compare.md")));

    const Result loose = kluft({"compare", "event", "all", "--tolerance", "1000 %", "-o", "c"});
    EXPECT_EQ(loose.code, 0) << loose.out;
    for (const char* name : {"c/curves.png", "c/cracks.png"})
        EXPECT_THAT(content_of(path(name)), StartsWith("\x89PNG")) << name;
    for (const char* name : {"c/curves.svg", "c/cracks.svg"})
        EXPECT_THAT(content_of(path(name)), HasSubstr("</svg>")) << name;
    EXPECT_THAT(content_of(path("c/compare.md")), HasSubstr("| peak axial stress (MPa) |"));

    const Result strict = kluft({"compare", "event", "explicit", "--tolerance", "1e-9", "-o", "c"});
    EXPECT_EQ(strict.code, 1) << strict.out;
    EXPECT_THAT(strict.out, AllOf(ContainsRegex("peak axial stress [^\n]*MISS\n"), HasSubstr("do not agree within")));
    const auto json = nlohmann::json::parse(content_of(path("c/compare.json")));
    EXPECT_EQ(json["agree"], false);
    EXPECT_EQ(json["b"]["integrator"], "explicit");
    EXPECT_EQ(json["quantities"]["peak_stress"]["a"], summary("event")["peak_stress"]);
    EXPECT_TRUE(json["quantities"]["solves"]["b"].is_null());
    EXPECT_EQ(json["quantities"]["time_steps"]["b"], summary("explicit")["time_steps"]);
}

// A run of pressures alone, without potential cracks, and one that left nothing but its history.
TEST_F(CommandLine, CompareLeavesOutWhatIsNotKnown) {
    write("tiny.yaml", tiny_scene);
    write("plain.yaml", R"(kluft: 1
materials: {rock: {youngs_modulus: 1 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e9, shear_stiffness: 1e9, friction_angle: 30}}
geometry: {domain: {rectangle: {width: 1, height: 2}}, reference_spacing: 1}
boundaries: {bottom: {support: pinned}}
stages: [{name: pressure, pressure: {top: 1 MPa}, steps: 1}]
)");
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "tiny", "--quiet"}).code, 0);
    ASSERT_EQ(kluft({"run", "plain.yaml", "-o", "plain", "--quiet"}).code, 0);
    fs::create_directory(path("bare"));
    fs::copy_file(path("tiny/history.csv"), path("bare/history.csv"));
    for (const Words& runs : {Words{"plain", "plain"}, Words{"plain", "tiny"}, Words{"tiny", "plain"},
                              Words{"bare", "tiny"}, Words{"bare", "bare"}, Words{"plain", "bare"}}) {
        const Result result = kluft(with({"compare", "-o", "c"}, runs));
        EXPECT_EQ(result.code, runs[0] == runs[1] ? 0 : 1)
            << ::testing::PrintToString(runs) << result.out << result.err;
        EXPECT_THAT(result.out, AllOf(Not(HasSubstr("nan")), Not(HasSubstr("inf")), HasSubstr(" -")));
        const auto json = nlohmann::json::parse(content_of(path("c/compare.json")));
        EXPECT_TRUE(json["quantities"].contains("curve_mean"));
        EXPECT_EQ(fs::exists(path("c/cracks.png")), runs != Words({"bare", "bare"}));
    }
    fs::remove(path("c/compare.json"));
    write("c/compare.md", "mine");
    expect_refused({"compare", "plain", "tiny", "-o", "c"},
                   HasSubstr("c/compare.md: expected a compare.md that a comparison wrote or none"));
    EXPECT_EQ(content_of(path("c/compare.md")), "mine");
}

TEST_F(CommandLine, CompareRefusesWhatIsNoRun) {
    write("file", "");
    fs::create_directories(path("results/case-3"));
    write("results/case-3/history.csv", "step\n");
    expect_refused({"compare", "results/case3", "results/case-3"},
                   HasSubstr("results/case3: expected a directory of results, found nothing; did you mean "
                             "'results/case-3'?"));
    expect_refused({"compare", "results/case-3", "file"}, HasSubstr("file: expected a directory of results, found a"));
    expect_refused({"compare", "results/case-3", "results"}, HasSubstr("found no history.csv in it"));
    expect_refused({"compare", "results/case-3", "results/case-3"},
                   HasSubstr("no columns 'stage', 'axial_strain', 'axial_stress', 'differential_stress'"));
    expect_refused({"compare", "results/case-3"}, HasSubstr("directories"));
    expect_refused({"compare", "a", "b", "--tolerance", "-1"}, HasSubstr("--tolerance: expected a fraction"));
    expect_refused({"compare", "a", "b", "-o", "file"}, HasSubstr("file: expected a directory for the results"));
    expect_refused({"compare", "a", "b", "--tolernace", "1"}, HasSubstr("did you mean '--tolerance'?"));
}

TEST_F(CommandLine, EnvelopeFitsThePeaksOfRuns) {
    write("tiny.yaml", tiny_scene);
    const std::string slippery = "interfaces.joint.friction_angle=10"; // loose cells of so few blocks lock at 20
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "low", "--quiet", "--set", slippery}).code, 0);
    ASSERT_EQ(
        kluft({"run", "tiny.yaml", "-o", "high", "--quiet", "--set", slippery, "--set",
               "stages.0.pressure={left: 0.2 MPa, right: 0.2 MPa, top: 0.2 MPa}", "--set", "stages.1.strain.value=2 %"})
            .code,
        0);
    const Result result = kluft({"envelope", "low", "high"});
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_THAT(result.out, AllOf(HasSubstr("MPa"), HasSubstr("deg"), HasSubstr("envelope.png")));
    EXPECT_THAT(content_of(path("envelope.png")), StartsWith("\x89PNG"));
    EXPECT_GT(lines_of(content_of(path("envelope.csv"))).size(), 2U);
    EXPECT_TRUE(nlohmann::json::parse(content_of(path("envelope.json")))["cohesion_error"].is_null());

    // A run, a table in MPa, the table that was written before, and strengths of tension tests.
    write("field.csv", "run,sigma_3 (MPa),sigma_1 (MPa),peak_reached\nf1,0.5,2.5,1\nf2,0.2,9,0\n");
    const Result mixed = kluft({"envelope", "low", "field.csv", "envelope.csv", "--tension", "40 kPa", "--tension",
                                "0.06 MPa", "-o", "mixed.svg"});
    EXPECT_EQ(mixed.code, 0) << mixed.err;
    EXPECT_THAT(mixed.out, AllOf(HasSubstr("4 points"), HasSubstr("tensile strength 0.0500 +- 0.0100 MPa"),
                                 HasSubstr("1 bound, left out of the fit: f2 (not yet falling)"),
                                 HasSubstr("the fit is contradicted: it lies below what was carried by f2")));
    const auto json = nlohmann::json::parse(content_of(path("mixed.json")));
    EXPECT_EQ(json["n_points"], 4);
    EXPECT_EQ(json["n_bounds"], 1);
    EXPECT_GT(json["cohesion_error"], 0.0);
}

// As of `-o "$results"` with a variable that is not set: the default would be another place than the one meant.
TEST_F(CommandLine, AnEmptyNameOfTheResultsIsNotTheDefault) {
    for (const char* const command : {"run", "draw", "compare", "envelope", "study", "export"})
        expect_refused({command, "a", "b", "-o", ""}, HasSubstr("--output: expected a name, found none"));
}

// 0xFC is the letter u with two dots in Latin 1, and nothing in UTF-8.
TEST_F(CommandLine, NameOfTheResultsThatIsNoUtf8IsRefused) {
    write("tiny.yaml", tiny_scene);
    for (const Words& words : {Words{"run", "tiny.yaml", "-o"}, Words{"study", "step-size", "tiny.yaml", "-o"},
                               Words{"draw", "tiny.yaml", "-o"}})
        expect_refused(with(words, {"S\xFC"
                                    "d.png"}),
                       HasSubstr("expected a name in UTF-8, found one with other bytes"));
    EXPECT_EQ(kluft({"draw", "tiny.yaml", "-o", "S\u00FCd.png"}).code, 0);
}

TEST_F(CommandLine, EnvelopeRefusesBadTables) {
    write("good.csv", "sigma_3,sigma_1\n0,1e6\n1e6,5e6\n");
    write("bad.csv", "sigma_3,sigma_1\n0,1e6\n1e6,high\n");
    write("rising.csv", "sigma_3,sigma_1,peak_reached\n0,1e6,1\n1e6,5e6,0\n");
    expect_refused({"envelope", "good.csv", "bad.csv"},
                   HasSubstr("bad.csv:3:5: sigma_1: expected a number, found 'high'"));
    expect_refused({"envelope", "absent.csv"}, HasSubstr("absent.csv: expected a table of tests, found no such file"));
    expect_refused({"envelope", "rising.csv"}, HasSubstr("rising 2: not yet falling"));
    expect_refused({"envelope", "good.csv", "--tension", "low"}, HasSubstr("--tension: expected a tensile strength"));
    expect_refused({"envelope", "good.csv", "--tension", "-1 MPa"}, HasSubstr("above zero"));
    expect_refused({"envelope", "good.csv", "-o", "good.png"}, HasSubstr("good.csv is one of the tests"));
    EXPECT_FALSE(fs::exists(path("envelope.png")));
    EXPECT_FALSE(fs::exists(path("good.png")));
}

// The table and the numbers beside a picture have names that a run gives its own.
TEST_F(CommandLine, EnvelopeTakesNoResultsPlace) {
    write("tiny.yaml", tiny_scene);
    write("good.csv", "sigma_3,sigma_1\n0,1e6\n1e6,5e6\n");
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--quiet"}).code, 0);
    for (const auto& [picture, result] : {std::pair{"r/history.png", "history.csv"},
                                          {"r/summary.svg", "summary.json"},
                                          {"r/cracks.png", "cracks.csv"}}) {
        const std::string before = content_of(path(std::string("r/") + result));
        expect_refused({"envelope", "good.csv", "-o", picture},
                       HasSubstr(std::string(result) + " is a result of the run"));
        EXPECT_EQ(content_of(path(std::string("r/") + result)), before);
    }
    EXPECT_EQ(kluft({"envelope", "good.csv", "-o", "r/envelope.png"}).code, 0);
    EXPECT_EQ(kluft({"envelope", "good.csv", "-o", "r/envelope.png"}).code, 0);

    for (const auto* const name : {"lab.csv", "lab.json"}) {
        write(name, "of a laboratory\n");
        expect_refused({"envelope", "good.csv", "-o", "lab.png"},
                       HasSubstr(std::string(name) + " is no file of an envelope"));
        EXPECT_EQ(content_of(path(name)), "of a laboratory\n");
        fs::remove(path(name));
    }
    write("envelope.png", "mine");
    expect_refused({"envelope", "good.csv"}, HasSubstr("envelope.png is no file of an envelope"));
    EXPECT_EQ(content_of(path("envelope.png")), "mine");
}

// Tables that have lost rows, or are not there at all, say less than the run's summary.
TEST_F(CommandLine, EnvelopeTellsOfARunWithoutASummary) {
    write("tiny.yaml", tiny_scene);
    write("good.csv", "sigma_3,sigma_1\n0,1e6\n1e6,5e6\n");
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--quiet"}).code, 0);
    EXPECT_THAT(kluft({"envelope", "r", "good.csv"}).err, Not(HasSubstr("summary")));
    fs::remove(path("r/summary.json"));
    const Result result = kluft({"envelope", "r", "good.csv"});
    EXPECT_EQ(result.code, 0);
    EXPECT_THAT(result.err, HasSubstr("r has no summary.json: its peak is that of its tables"));
}

TEST_F(CommandLine, EnvelopeAsksForAllRowsOfARun) {
    write("tiny.yaml", tiny_scene);
    write("good.csv", "sigma_3,sigma_1\n0,1e6\n1e6,5e6\n");
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--quiet"}).code, 0);
    for (const std::string name : {"history.csv", "equilibria.csv"}) {
        const std::string whole = content_of(path("r/" + name));
        write("r/" + name, whole.substr(0, whole.find('\n', whole.size() / 2) + 1));
        expect_refused({"envelope", "r", "good.csv"},
                       AllOf(HasSubstr("r: expected all rows of the run"), HasSubstr(name + " ends at load step")));
        write("r/" + name, whole);
    }
    fs::remove(path("r/equilibria.csv"));
    expect_refused({"envelope", "r", "good.csv"}, HasSubstr("equilibria.csv ends at load step 0"));
}

// A study in the directory of one of another scene would take the place of its runs, whose cases have the same names.
TEST_F(CommandLine, StudyKeepsTheRunsOfAnotherScenesStudy) {
    write("tiny.yaml", tiny_scene);
    write("other.yaml", std::string(tiny_scene) + "output: {pictures: false}\n");
    write("a.yaml", "scene: tiny.yaml\nvary: {stages.1.steps: [1]}\n");
    write("c.yaml", "scene: other.yaml\nvary: {stages.1.steps: [2]}\n"); // no case of the same name
    write("b.yaml", "scene: other.yaml\nset: {interfaces.joint.friction_angle: 10}\nvary: {stages.1.steps: [1]}\n");
    ASSERT_EQ(kluft({"study", "a.yaml", "-o", "s", "--quiet"}).code, 0);
    const std::string table = content_of(path("s/study.csv"));
    expect_refused({"study", "b.yaml", "-o", "s"},
                   ContainsRegex("s: expected results of a study of .*other.yaml or none, found "
                                 "those of a study of .*tiny.yaml .*--force"));
    expect_refused({"study", "c.yaml", "-o", "s"}, HasSubstr("--force"));
    expect_refused({"study", "b.yaml", "-o", "s", "--collect"}, HasSubstr("--force"));
    expect_refused({"study", "step-size", "other.yaml", "-o", "s"}, HasSubstr("--force"));
    EXPECT_FALSE(fs::exists(path("s/study.yaml")));
    EXPECT_EQ(content_of(path("s/study.csv")), table);
    EXPECT_EQ(kluft({"study", "a.yaml", "-o", "s", "--quiet"}).code, 0);
    EXPECT_EQ(kluft({"study", "b.yaml", "-o", "s", "--quiet", "--force"}).code, 0);
    EXPECT_NE(content_of(path("s/study.csv")), table);
    EXPECT_EQ(kluft({"study", "a.yaml", "-o", "s", "--quiet", "--force"}).code, 0);
    EXPECT_EQ(kluft({"study", "c.yaml", "-o", "s", "--quiet", "--force"}).code, 0); // nothing of a is left
    EXPECT_EQ(kluft({"study", "c.yaml", "-o", "s", "--quiet"}).code, 0);
    fs::create_directory(path("own"));
    write("own/study.csv", "mine\n");
    expect_refused({"study", "a.yaml", "-o", "own"},
                   HasSubstr("own/study.csv: expected a study.csv that a study wrote or none"));
    EXPECT_EQ(content_of(path("own/study.csv")), "mine\n");
}

TEST_F(CommandLine, StudyTakesThePlaceOfNoFileThatNoStudyWrote) {
    write("tiny.yaml", tiny_scene);
    write("a.yaml", "scene: tiny.yaml\nvary: {stages.1.steps: [1]}\n");
    fs::create_directories(path("own/cases/steps=1"));
    const Words words{"study", "a.yaml", "-o", "own", "--quiet"};
    for (const std::string name : {"study.md", "study.html", "cases.txt", "study-curves.svg", "cases/steps=1/notes"}) {
        write("own/" + name, "mine");
        expect_refused(words, AllOf(HasSubstr("which would be lost"), HasSubstr("--force")));
        EXPECT_EQ(content_of(path("own/" + name)), "mine");
        fs::remove(path("own/" + name));
    }
    write("own/cases/steps=1/case.json.part", "{"); // of a study that was killed
    write("own/Makefile", "mine");
    expect_refused(with(words, {"--emit", "make"}), HasSubstr("own/Makefile: expected a Makefile that a study wrote"));
    EXPECT_EQ(kluft(words).code, 0);
    EXPECT_EQ(content_of(path("own/Makefile")), "mine");
    EXPECT_EQ(kluft(words).code, 0);
    fs::create_directory(path("new"));
    write("new/study.md", "mine");
    EXPECT_EQ(kluft({"study", "a.yaml", "-o", "new", "--quiet", "--force"}).code, 0);
    EXPECT_NE(content_of(path("new/study.md")), "mine");
}

// A table of cases that wait would take the place of numbers, and other runs that of those which the table is of.
TEST_F(CommandLine, StudyKeepsTheRunsFromBeforeAChangeOfItsScene) {
    write("tiny.yaml", tiny_scene);
    write("a.yaml", "scene: tiny.yaml\nvary: {stages.1.steps: [1, 2]}\n");
    const Words words{"study", "a.yaml", "-o", "s", "--quiet"}, collect{"study", "a.yaml", "-o", "s", "--collect"};
    ASSERT_EQ(kluft(words).code, 0);
    write("tiny.yaml", std::regex_replace(tiny_scene, std::regex("value: 1 %"), "value: 0.5 %"));
    const auto before = files_in("s");
    for (const Words& each : {words, collect})
        expect_refused(each,
                       AllOf(HasSubstr("cases/steps=1 those before a change: stages.1.strain.value is '1 %' there "
                                       "and '0.5 %' here"),
                             HasSubstr("--force")));
    EXPECT_TRUE(files_in("s") == before);
    EXPECT_EQ(kluft(with(words, {"--force"})).code, 0);
    EXPECT_EQ(kluft(collect).code, 0);
    EXPECT_EQ(kluft(words).code, 0);
}

// The way from the directory to the scene is another one then; the scene is not.
TEST_F(CommandLine, StudyThatWasMovedIsTheSame) {
    write("tiny.yaml", tiny_scene);
    write("a.yaml", "scene: tiny.yaml\nvary: {stages.1.steps: [1, 2]}\n");
    ASSERT_EQ(kluft({"study", "a.yaml", "-o", "s", "--quiet"}).code, 0);
    const std::string table = content_of(path("s/study.csv"));
    fs::create_directory(path("deeper"));
    fs::rename(path("s"), path("deeper/s"));
    EXPECT_EQ(kluft({"study", "a.yaml", "-o", "deeper/s", "--collect"}).code, 0);
    EXPECT_EQ(content_of(path("deeper/s/study.csv")), table);
    write("b.yaml", "scene: tiny.yaml\nvary: {stages.1.steps: [2, 3]}\n");
    EXPECT_EQ(kluft({"study", "b.yaml", "-o", "deeper/s", "--quiet"}).code, 0); // a case of a is not planned any more
}

// Of another scene, whose body is the same: no fingerprint tells them apart.
TEST_F(CommandLine, AStateOfAnotherRunIsTold) {
    write("tiny.yaml", tiny_scene);
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "r", "--quiet"}).code, 0);
    ASSERT_EQ(kluft({"run", "tiny.yaml", "-o", "other", "--quiet", "--set", "stages.1.strain.value=0.5 %"}).code, 0);
    fs::copy_file(path("other/state.h5"), path("r/state.h5"), fs::copy_options::overwrite_existing);
    const auto told = HasSubstr("found one of another: stages.1.strain.value");
    expect_refused({"report", "r"}, told);
    expect_refused({"draw", "r", "--step", "last", "-o", "r.png"}, told);
}

TEST_F(CommandLine, EnvelopeRefusesWhatIsNoRun) {
    write("file", "");
    fs::create_directory(path("empty"));
    expect_refused({"envelope", "absent"}, HasSubstr("absent: expected a directory of results, found nothing"));
    expect_refused({"envelope", "file"}, HasSubstr("file: expected a directory of results or a table of tests (.csv)"));
    expect_refused({"envelope", "empty"}, HasSubstr("found no history.csv"));
    expect_refused({"envelope", "empty", "--compare", "x"}, HasSubstr("--compare"));
    EXPECT_FALSE(fs::exists(path("envelope.png")));
}

} // namespace
} // namespace kluft
