// The files of the states that a run keeps: fields for ParaView, and tables of the forces on the blocks.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/output/vtu.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// What the files say beside numbers.
struct SeriesNames {
    FieldNames fields;
    std::vector<std::string> laws; ///< of the interface of each law
    bool has_axial_strain = false; ///< the run moves a platen
};

/// The series of kept states in a results directory: `fields.pvd` over `fields/blocks_<step>.vtu` (part 0) and
/// `fields/interfaces_<step>.vtu` (part 1), and beside each `contacts/<step>.csv` and `supports/<step>.csv`; <step> has six
/// digits or more. The time in `fields.pvd` is the axial strain where a platen is moved, else stage + load factor; where this
/// would not increase from state to state, as in unloading, it is the next of axial strain, stage + load factor, load step
/// that does.
class FieldSeries {
public:
    /// A series without files in `directory`; files of an earlier run are removed. Throws ResourceError.
    [[nodiscard]] static FieldSeries create(const std::filesystem::path& directory, SeriesNames names);
    /// Goes on with the files of the load steps in `history`; later ones are removed. Throws ResourceError.
    [[nodiscard]] static FieldSeries resume(const std::filesystem::path& directory, SeriesNames names,
                                            const std::vector<StepRecord>& history);
    /// Removes all that a series owns in `directory`. Throws ResourceError.
    static void remove(const std::filesystem::path& directory);

    /// Writes the files of a load step, then the series with them in it. Throws ResourceError.
    void add(const BlockSystem& system, const FieldRecord& fields, const StepRecord& record);

    /// Takes the state of a load step out of the series, then removes its files. Throws ResourceError.
    void drop(int step);

    /// Whether the state of the load step is in the series.
    [[nodiscard]] bool has(int step) const;
    /// Ascending.
    [[nodiscard]] std::vector<int> steps() const;

private:
    /// A state of the series, and what its time may be.
    struct Kept {
        int step = 0;
        double axial_strain = 0.0;
        double stage_and_factor = 0.0;
    };

    FieldSeries(std::filesystem::path directory, SeriesNames names);
    void keep(const StepRecord& record);
    void write_series() const;

    std::filesystem::path directory_;
    SeriesNames names_;
    std::vector<Kept> kept_; ///< ascending steps
};

/// The load steps whose states a results directory keeps, ascending.
[[nodiscard]] std::vector<int> kept_steps(const std::filesystem::path& directory);

/// "contacts/000000.csv": the first of the files of kept states, by name; "" if there is none.
[[nodiscard]] std::string first_kept_file(const std::filesystem::path& directory);

} // namespace kluft
