#include "kluft/output/field_reader.hpp"

#include <charconv>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/block_outline.hpp"

namespace kluft {

namespace fs = std::filesystem;

namespace {

/// The compressed arrays of one file, by name. Sizes in it are not trusted.
class StoredArrays {
public:
    explicit StoredArrays(fs::path path) : path_(std::move(path)), content_(read_file(path_)) {
        constexpr std::string_view mark = "<AppendedData encoding=\"raw\">\n_";
        const std::size_t at = content_.find(mark);
        if (at == std::string::npos) refuse("a field file of this version");
        header_ = std::string_view(content_).substr(0, at);
        data_ = std::string_view(content_).substr(at + mark.size());
    }

    /// Exactly n numbers.
    template <class Number> [[nodiscard]] std::vector<Number> read(std::string_view name, std::size_t n) const {
        std::vector<Number> numbers(n);
        std::size_t at = offset_of(name);
        const auto next = [&] {
            std::uint64_t number = 0;
            if (data_.size() - at < sizeof number) refuse_array(name);
            std::memcpy(&number, data_.data() + at, sizeof number);
            at += sizeof number;
            return number;
        };
        const std::uint64_t n_pieces = next();
        (void)next(); // the sizes of pieces are known from what comes out of them
        (void)next();
        if (n_pieces > (data_.size() - at) / sizeof(std::uint64_t)) refuse_array(name);
        std::vector<std::uint64_t> sizes(n_pieces);
        for (std::uint64_t& size : sizes) size = next();
        auto* const bytes = reinterpret_cast<Bytef*>(numbers.data()); // NOLINT: bytes are bytes
        const std::size_t n_bytes = n * sizeof(Number);
        std::size_t done = 0;
        for (const std::uint64_t size : sizes) {
            uLongf room = n_bytes - done;
            if (size > data_.size() - at) refuse_array(name);
            const auto* const piece = reinterpret_cast<const Bytef*>(data_.data() + at); // NOLINT: bytes are bytes
            if (::uncompress(bytes + done, &room, piece, size) != Z_OK) refuse_array(name);
            done += room;
            at += size;
        }
        if (done != n_bytes) refuse_array(name);
        return numbers;
    }

    [[noreturn]] void refuse(std::string_view expected) const {
        throw InputError(fmt::format("{}: expected {}, found something else", path_.string(), expected));
    }

private:
    [[noreturn]] void refuse_array(std::string_view name) const {
        refuse(fmt::format("an array '{}' of the body that the results are of", name));
    }

    [[nodiscard]] std::size_t offset_of(std::string_view name) const {
        const std::size_t named = header_.find(fmt::format("Name=\"{}\"", name));
        constexpr std::string_view key = "offset=\"";
        const std::size_t at = named == std::string_view::npos ? named : header_.find(key, named);
        std::size_t offset = 0;
        if (at == std::string_view::npos) refuse_array(name);
        const std::string_view digits = header_.substr(at + key.size());
        const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), offset);
        if (result.ec != std::errc() || offset > data_.size()) refuse_array(name);
        return offset;
    }

    fs::path path_;
    std::string content_;
    std::string_view header_, data_;
};

std::vector<Vec2> vectors_of(const std::vector<double>& numbers) {
    std::vector<Vec2> vectors;
    for (std::size_t i = 0; i + 2 < numbers.size(); i += 3) vectors.emplace_back(numbers[i], numbers[i + 1]);
    return vectors;
}

void read_blocks(const StoredArrays& file, const BlockSystem& system, FieldRecord& fields) {
    fields.displacement = vectors_of(file.read<double>("displacement", 3 * first_vertices(system).back()));
    const auto stress = file.read<double>("stress", 9 * system.blocks.size());
    for (std::size_t b = 0; b < system.blocks.size(); ++b) {
        const double* const s = &stress[9 * b];
        Mat2 tensor;
        tensor << -s[0], -s[1], -s[3], -s[4];
        fields.stress.push_back(tensor);
        fields.stress_zz.push_back(-s[8]);
    }
}

void read_interfaces(const StoredArrays& file, const BlockSystem& system, FieldRecord& fields) {
    const std::size_t n = system.interfaces.size();
    const auto state = file.read<std::int32_t>("state", n);
    const auto bonded = file.read<std::int32_t>("bonded", n);
    const auto crack_mode = file.read<std::int32_t>("crack_mode", n);
    const auto normal = file.read<double>("normal_traction", n);
    const auto shear = file.read<double>("shear_traction", n);
    const auto gap = file.read<double>("gap", n);
    const auto slip = file.read<double>("slip", n);
    const auto relative = vectors_of(file.read<double>("relative_displacement", 3 * n));
    const auto force = vectors_of(file.read<double>("contact_force", 3 * n));
    for (std::size_t i = 0; i < n; ++i) {
        const ContactState contact = state[i] == 0   ? ContactState::open
                                     : state[i] == 1 ? ContactState::sliding
                                                     : ContactState::locked;
        fields.interfaces.push_back({bonded[i] != 0, crack_mode[i] != 0,
                                     crack_mode[i] == 2 ? CrackMode::shear : CrackMode::tension, contact, -normal[i],
                                     shear[i], gap[i], slip[i], relative[i], force[i]});
    }
}

} // namespace

FieldRecord read_fields(const fs::path& blocks, const fs::path& interfaces, const BlockSystem& system) {
    FieldRecord fields;
    read_blocks(StoredArrays(blocks), system, fields);
    read_interfaces(StoredArrays(interfaces), system, fields);
    return fields;
}

FieldRecord read_fields(const fs::path& directory, int step, const BlockSystem& system) {
    return read_fields(directory / fmt::format("fields/blocks_{:06}.vtu", step),
                       directory / fmt::format("fields/interfaces_{:06}.vtu", step), system);
}

} // namespace kluft
