// The reader of saved states: any bytes as they are; a whole file of which some bytes are others; and one whose arrays have
// other numbers, lengths and types, or are missing, sealed as Kluft does.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <hdf5.h>

#include "kluft/output/atomic_file.hpp"
#include "kluft/output/state_file.hpp"
#include "refused.hpp"

namespace {

using namespace kluft;

/// A state file to begin with; its format changes too often to be kept.
std::string first_file() {
    State state;
    state.body.displacement = Eigen::VectorXd::LinSpaced(12, -1.0, 1.0);
    state.body.interfaces = {InterfaceStatus::potential_crack, InterfaceStatus::fracture};
    state.body.bond_shear = {1.0, -2.0};
    state.body.contacts = {{{0, 1, 2, 3, -1}, {1.25e5, 1e-7}}, {{4, 5, 6, 7, 2}, {-0.1, 0.0}}};
    state.imbalance = {1, 0.25, {{1, Vec2(0.6, -0.8), 0}}};
    state.memory.near_pairs = {{0, 3}, {2, 1}};
    state.memory.kept_points = {ContactPoint{.block_a = 3, .block_b = 2, .weight = 0.3, .along = 0.7, .law = 1}};
    state.body.platen_points = {{0, 1, 2, true, {}, 0.1, 0.2, 0.3}};
    const auto path = std::filesystem::temp_directory_path() / ("kluft-fuzz-" + std::to_string(getpid()));
    write_state(path, state, "fuzz", "kluft: 1\n", "{}");
    const std::string bytes = read_file(path);
    std::filesystem::remove(path);
    return bytes;
}

const std::string& whole_file() {
    static const std::string file = first_file();
    return file;
}

hid_t checked(hid_t id) {
    if (id < 0) throw std::runtime_error("HDF5 does not do what the fuzzer wants");
    return id;
}

hid_t file_in_memory(const std::string& image) {
    const hid_t access = checked(H5Pcreate(H5P_FILE_ACCESS));
    checked(H5Pset_fapl_core(access, 1U << 16U, false));
    checked(H5Pset_file_image(access, const_cast<char*>(image.data()), image.size()));
    const hid_t file = checked(H5Fopen("state", H5F_ACC_RDWR, access));
    H5Pclose(access);
    return file;
}

std::string image_of(hid_t file) {
    checked(H5Fflush(file, H5F_SCOPE_GLOBAL));
    std::string image(static_cast<std::size_t>(H5Fget_file_image(file, nullptr, 0)), '\0');
    checked(static_cast<hid_t>(H5Fget_file_image(file, image.data(), image.size())));
    return image;
}

std::vector<std::string> array_names(hid_t file) {
    H5G_info_t info{};
    checked(H5Gget_info(file, &info));
    std::vector<std::string> names;
    for (hsize_t i = 0; i < info.nlinks; ++i) {
        char name[128] = "";
        checked(static_cast<hid_t>(
            H5Lget_name_by_idx(file, ".", H5_INDEX_NAME, H5_ITER_INC, i, name, sizeof name, H5P_DEFAULT)));
        names.emplace_back(name);
    }
    return names;
}

/// What the fuzzer asks to do with one array.
struct Edit {
    std::uint8_t array, action;
    std::uint16_t place;
    double value;
};

/// An array as numbers, whatever it holds.
std::vector<double> numbers_of(hid_t file, const std::string& name, H5T_class_t& kind, std::size_t& size) {
    const hid_t set = checked(H5Dopen2(file, name.c_str(), H5P_DEFAULT));
    const hid_t space = checked(H5Dget_space(set));
    const hid_t type = checked(H5Dget_type(set));
    kind = H5Tget_class(type);
    size = H5Tget_size(type);
    std::vector<double> numbers(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    if (!numbers.empty()) checked(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()));
    H5Tclose(type);
    H5Sclose(space);
    H5Dclose(set);
    return numbers;
}

void replace(hid_t file, const std::string& name, const std::vector<double>& numbers, hid_t type) {
    checked(H5Ldelete(file, name.c_str(), H5P_DEFAULT));
    const hsize_t extent = numbers.size();
    const hid_t space = checked(H5Screate_simple(1, &extent, nullptr));
    const hid_t set = checked(H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    if (extent > 0) checked(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()));
    H5Dclose(set);
    H5Sclose(space);
}

void apply(hid_t file, const std::vector<std::string>& names, const Edit& edit) {
    const std::string& name = names[edit.array % names.size()];
    if (H5Lexists(file, name.c_str(), H5P_DEFAULT) <= 0) return;
    H5T_class_t kind = H5T_NO_CLASS;
    std::size_t size = 0;
    auto numbers = numbers_of(file, name, kind, size);
    hid_t type = kind == H5T_FLOAT ? H5T_NATIVE_DOUBLE : size == 1 ? H5T_NATIVE_UINT8 : H5T_NATIVE_INT;
    switch (edit.action % 8) {
    case 0:
        checked(H5Ldelete(file, name.c_str(), H5P_DEFAULT));
        return;
    case 1:
        type = type == H5T_NATIVE_DOUBLE ? H5T_NATIVE_INT : H5T_NATIVE_DOUBLE;
        break;
    case 2:
        numbers.resize(edit.place % 80, edit.value);
        break;
    case 3:
        numbers.push_back(edit.value);
        break;
    case 4:
        numbers.assign(numbers.size(), edit.value);
        break;
    default:
        if (!numbers.empty()) numbers[edit.place % numbers.size()] = edit.value;
    }
    replace(file, name, numbers, type);
}

void read_parts(const fuzz::MemoryFile& file) {
    fuzz::is_taken([&] { (void)read_state_scene(file.path()); });
    fuzz::is_taken([&] { (void)read_state_tables(file.path()); });
}

void read_whole(const fuzz::MemoryFile& file) {
    fuzz::is_taken([&] { (void)read_state(file.path(), "fuzz"); });
}

/// The n-th record of the bytes; false where they end before.
template <class Record> bool take(const std::uint8_t* bytes, std::size_t size, std::size_t n, Record& record) {
    if ((n + 1) * sizeof record > size) return false;
    std::memcpy(&record, bytes + n * sizeof record, sizeof record);
    return true;
}

std::string with_other_bytes(const std::uint8_t* bytes, std::size_t size) {
    std::string file = whole_file();
    std::uint32_t change = 0;
    for (std::size_t n = 0; take(bytes, size, n, change); ++n)
        file[change / 256 % file.size()] ^= static_cast<char>(change % 256);
    return file;
}

std::string with_other_arrays(const std::uint8_t* bytes, std::size_t size) {
    constexpr std::size_t most_edits = 8;
    const std::string& whole = whole_file();
    const hid_t file = file_in_memory(whole.substr(0, whole.rfind("\nkluft digest ")));
    static const auto names = array_names(file);
    Edit edit{};
    for (std::size_t n = 0; n < most_edits && take(bytes, size, n, edit); ++n) apply(file, names, edit);
    const std::string image = image_of(file);
    H5Fclose(file);
    return sealed(image);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    if (size % 4 < 2) {
        const fuzz::MemoryFile file(size % 4 == 0 ? std::string(fuzz::text_of(bytes, size))
                                                  : with_other_bytes(bytes, size));
        read_whole(file);
        read_parts(file);
        return 0;
    }
    const fuzz::MemoryFile file(with_other_arrays(bytes, size));
    size % 4 == 2 ? read_whole(file) : read_parts(file);
    return 0;
}
