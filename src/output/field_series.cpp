#include "kluft/output/field_series.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <functional>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "kluft/output/atomic_file.hpp"
#include "kluft/output/force_tables.hpp"

namespace kluft {

namespace fs = std::filesystem;

namespace {

/// One of the files of a kept state: `folder`/`prefix`<step>`ending`.
struct KeptFile {
    std::string_view folder, prefix, ending;
};
constexpr KeptFile contacts_file{"contacts", "", ".csv"};
constexpr KeptFile supports_file{"supports", "", ".csv"};
constexpr KeptFile blocks_file{"fields", "blocks_", ".vtu"};
constexpr KeptFile interfaces_file{"fields", "interfaces_", ".vtu"};
/// In the order in which they are written: a state that has the last one has all.
constexpr std::array kept_files{contacts_file, supports_file, blocks_file, interfaces_file};
constexpr std::array kept_folders{contacts_file.folder, supports_file.folder, blocks_file.folder};

std::string name_of(const KeptFile& kind, int step) {
    return fmt::format("{}/{}{:06}{}", kind.folder, kind.prefix, step, kind.ending);
}

/// The load step in the name of such a file, or of one that is not finished.
std::optional<int> step_of(const std::string& name, const KeptFile& kind) {
    if (!name.starts_with(kind.prefix)) return std::nullopt;
    int step = 0;
    const char* const end = name.data() + name.size();
    const auto result = std::from_chars(name.data() + kind.prefix.size(), end, step);
    if (result.ec != std::errc()) return std::nullopt;
    const std::string_view rest(result.ptr, end);
    const bool is_ours = rest == kind.ending || rest == std::string(kind.ending) + ".part";
    return is_ours ? std::optional(step) : std::nullopt;
}

struct FoundFile {
    fs::path path;
    int step = 0;
    bool is_last = false;  ///< of those of its state
    bool is_whole = false; ///< not one that is being written
};

std::vector<FoundFile> files_in(const fs::path& directory) {
    std::vector<FoundFile> files;
    for (const KeptFile& kind : kept_files) {
        std::error_code none;
        for (const auto& entry : fs::directory_iterator(directory / kind.folder, none)) {
            const std::string name = entry.path().filename();
            if (const auto step = step_of(name, kind))
                files.push_back({entry.path(), *step, kind.prefix == interfaces_file.prefix, !name.ends_with(".part")});
        }
    }
    return files;
}

void make_folders(const fs::path& directory) {
    for (const std::string_view folder : kept_folders) make_directory(directory / folder);
}

bool increases(const std::vector<double>& times) {
    return std::ranges::adjacent_find(times, std::greater_equal{}) == times.end();
}

} // namespace

FieldSeries::FieldSeries(fs::path directory, SeriesNames names)
    : directory_(std::move(directory)), names_(std::move(names)) {}

FieldSeries FieldSeries::create(const fs::path& directory, SeriesNames names) {
    remove(directory);
    make_folders(directory);
    FieldSeries series(directory, std::move(names));
    series.write_series();
    return series;
}

FieldSeries FieldSeries::resume(const fs::path& directory, SeriesNames names, const std::vector<StepRecord>& history) {
    make_folders(directory);
    FieldSeries series(directory, std::move(names));
    std::map<int, const StepRecord*> rows;
    for (const StepRecord& row : history) rows[row.step] = &row;
    std::vector<int> steps;
    for (const FoundFile& file : files_in(directory)) {
        if (!rows.contains(file.step) || !file.is_whole)
            remove_file(file.path);
        else if (file.is_last)
            steps.push_back(file.step);
    }
    std::ranges::sort(steps);
    for (const int step : steps) series.keep(*rows[step]);
    series.write_series();
    return series;
}

void FieldSeries::remove(const fs::path& directory) {
    remove_file(directory / "fields.pvd");
    for (const FoundFile& file : files_in(directory)) remove_file(file.path);
    for (const std::string_view name : kept_folders) {
        std::error_code ignored;
        const fs::path folder = directory / name;                          // a link to where there is more room stays
        if (!fs::is_symlink(folder, ignored)) fs::remove(folder, ignored); // only when nothing else is in it
    }
}

void FieldSeries::add(const BlockSystem& system, const FieldRecord& fields, const StepRecord& record) {
    const auto write = [&](const KeptFile& kind, const std::string& content) {
        write_file(directory_ / name_of(kind, record.step), content);
    };
    write_file(directory_ / name_of(contacts_file, record.step),
               [&](const Put& put) { put_contacts_csv(system, fields.contacts, names_.laws, put); });
    write(supports_file, supports_csv(system, fields.supports));
    write(blocks_file, blocks_vtu(system, fields, names_.fields, record));
    write(interfaces_file, interfaces_vtu(system, fields, names_.fields, record));
    if (!has(record.step)) keep(record);
    write_series();
}

void FieldSeries::drop(int step) {
    std::erase_if(kept_, [&](const Kept& each) { return each.step == step; });
    write_series();
    for (const KeptFile& kind : kept_files) remove_file(directory_ / name_of(kind, step));
}

bool FieldSeries::has(int step) const { return std::ranges::find(kept_, step, &Kept::step) != kept_.end(); }

std::vector<int> kept_steps(const fs::path& directory) {
    std::vector<int> steps;
    for (const FoundFile& file : files_in(directory))
        if (file.is_last && file.is_whole) steps.push_back(file.step);
    std::ranges::sort(steps);
    return steps;
}

std::string first_kept_file(const fs::path& directory) {
    std::vector<std::string> names;
    for (const FoundFile& file : files_in(directory)) names.push_back(file.path.lexically_relative(directory).string());
    return names.empty() ? std::string{} : *std::ranges::min_element(names);
}

std::vector<int> FieldSeries::steps() const {
    std::vector<int> steps;
    for (const Kept& each : kept_) steps.push_back(each.step);
    return steps;
}

void FieldSeries::keep(const StepRecord& record) {
    const Kept added{record.step, record.axial_strain, record.stage + record.load_factor};
    kept_.insert(std::ranges::upper_bound(kept_, added.step, {}, &Kept::step), added);
}

void FieldSeries::write_series() const {
    std::vector<double> strains, places, steps;
    for (const Kept& each : kept_) {
        strains.push_back(each.axial_strain);
        places.push_back(each.stage_and_factor);
        steps.push_back(each.step);
    }
    const auto& [time, meaning] = names_.has_axial_strain && increases(strains) ? std::pair(strains, "axial strain")
                                  : increases(places) ? std::pair(places, "stage + load factor")
                                                      : std::pair(steps, "load step");
    std::string text = fmt::format("<?xml version=\"1.0\"?>\n<!-- timestep: {} -->\n"
                                   "<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n",
                                   meaning);
    for (std::size_t i = 0; i < kept_.size(); ++i) {
        int part = 0;
        for (const KeptFile& kind : {blocks_file, interfaces_file})
            text += fmt::format("<DataSet timestep=\"{}\" group=\"\" part=\"{}\" file=\"{}\"/>\n", time[i], part++,
                                name_of(kind, kept_[i].step));
    }
    write_file(directory_ / "fields.pvd", text + "</Collection>\n</VTKFile>\n");
}

} // namespace kluft
