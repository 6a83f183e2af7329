#include "kluft/output/state_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <hdf5.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/digest.hpp"
#include "kluft/output/atomic_file.hpp"

namespace kluft {

namespace {

constexpr int format_version = 16;
constexpr std::string_view format_name = "kluft state";

constexpr std::string_view seal = "\nkluft digest "; // before the digest of all that stands before the seal
constexpr std::size_t digest_digits = 16;

/// What went wrong inside HDF5; the callers add the file's name.
struct Hdf5Failure {
    std::string what;
};

hid_t checked(hid_t id, const std::string& what) {
    if (id < 0) throw Hdf5Failure{what};
    return id;
}

/// Owns an HDF5 identifier of any kind.
class Identifier {
public:
    Identifier(hid_t id, herr_t (*close)(hid_t), const std::string& what) : id_(checked(id, what)), close_(close) {}
    Identifier(const Identifier&) = delete;
    Identifier& operator=(const Identifier&) = delete;
    ~Identifier() { close_(id_); }
    operator hid_t() const { return id_; }

private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

/// HDF5 prints its error stack by default; here every result is looked at instead. What it closes at the end of the program by
/// itself is closed here already, but for what a damaged file left half open, of which it would print a line.
class SilentErrors {
public:
    SilentErrors() {
        [[maybe_unused]] static const herr_t closes_nothing = H5dont_atexit();
        H5Eget_auto2(H5E_DEFAULT, &function_, &client_);
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    }
    SilentErrors(const SilentErrors&) = delete;
    SilentErrors& operator=(const SilentErrors&) = delete;
    ~SilentErrors() { H5Eset_auto2(H5E_DEFAULT, function_, client_); }

private:
    H5E_auto2_t function_ = nullptr;
    void* client_ = nullptr;
};

/// Access to a file in memory, with no file behind it.
Identifier memory_access() {
    constexpr std::size_t increment = 1U << 20U;
    const hid_t id = H5Pcreate(H5P_FILE_ACCESS);
    if (id >= 0 && H5Pset_fapl_core(id, increment, false) < 0) {
        H5Pclose(id);
        throw Hdf5Failure{"no memory driver"};
    }
    return {id, H5Pclose, "no access properties"};
}

Identifier text_type(std::size_t size) {
    const hid_t id = H5Tcopy(H5T_C_S1);
    if (id >= 0) H5Tset_size(id, std::max<std::size_t>(size, 1));
    return {id, H5Tclose, "no text type"};
}

void write_text(hid_t file, const char* name, std::string_view text) {
    const Identifier type = text_type(text.size());
    const Identifier space(H5Screate(H5S_SCALAR), H5Sclose, name);
    const Identifier attribute(H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, name);
    const std::string padded = text.empty() ? std::string(1, '\0') : std::string(text);
    checked(H5Awrite(attribute, type, padded.data()), name);
}

/// Nothing in a file is larger than the file: what it holds is not compressed.
void require_room(hid_t file, std::size_t count, std::size_t size_of_one, const char* name) {
    hsize_t size = 0;
    checked(H5Fget_filesize(file, &size), name);
    if (size_of_one == 0 || count > size / size_of_one)
        throw Hdf5Failure{std::string(name) + " is larger than the file"};
}

std::string read_text(hid_t file, const char* name) {
    const Identifier attribute(H5Aopen(file, name, H5P_DEFAULT), H5Aclose, std::string("no ") + name);
    const Identifier stored(H5Aget_type(attribute), H5Tclose, name);
    if (H5Tget_class(stored) != H5T_STRING || H5Tis_variable_str(stored) > 0) throw Hdf5Failure{name};
    require_room(file, H5Tget_size(stored), 1, name);
    std::string text(H5Tget_size(stored), '\0');
    checked(H5Aread(attribute, stored, text.data()), name);
    return text.substr(0, text.find('\0'));
}

template <class Number> hid_t memory_type();
template <> hid_t memory_type<double>() { return H5T_NATIVE_DOUBLE; }
template <> hid_t memory_type<int>() { return H5T_NATIVE_INT; }
template <> hid_t memory_type<std::uint8_t>() { return H5T_NATIVE_UINT8; }

bool holds_none(const double* values, std::size_t size) {
    return std::any_of(values, values + size, [](double value) { return std::isnan(value); });
}

template <class Number> void write_array(hid_t file, const char* name, const Number* values, std::size_t size) {
    if constexpr (std::is_same_v<Number, double>) {
        if (holds_none(values, size))
            throw NoEquilibriumError(std::string(name) + " of the state is no number; the state saved before stays");
    }
    const hsize_t extent = size;
    const Identifier space(H5Screate_simple(1, &extent, nullptr), H5Sclose, name);
    const hid_t type = memory_type<Number>();
    const Identifier set(H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose, name);
    if (size > 0) checked(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), name);
}

template <class Number> std::vector<Number> read_array(hid_t file, const char* name) {
    const Identifier set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose, std::string("no ") + name);
    const Identifier space(H5Dget_space(set), H5Sclose, name);
    const hssize_t size = H5Sget_simple_extent_npoints(space);
    if (size < 0) throw Hdf5Failure{name};
    const Identifier stored(H5Dget_type(set), H5Tclose, name);
    if (H5Tequal(stored, memory_type<Number>()) <= 0) throw Hdf5Failure{std::string(name) + " has another type"};
    require_room(file, static_cast<std::size_t>(size), sizeof(Number), name);
    std::vector<Number> values(static_cast<std::size_t>(size));
    if (size > 0) checked(H5Dread(set, memory_type<Number>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), name);
    if constexpr (std::is_same_v<Number, double>) {
        if (holds_none(values.data(), values.size())) throw Hdf5Failure{std::string(name) + " is no number"};
    }
    return values;
}

template <class Number> Number read_scalar(hid_t file, const char* name) {
    const auto values = read_array<Number>(file, name);
    if (values.size() != 1) throw Hdf5Failure{name};
    return values.front();
}

/// Stores the members of a state one by one.
struct Writer {
    hid_t file;

    void operator()(const char* name, const int& value) { write_array(file, name, &value, 1); }
    void operator()(const char* name, const double& value) { write_array(file, name, &value, 1); }
    void operator()(const char* name, const bool& value) {
        const int number = value ? 1 : 0;
        write_array(file, name, &number, 1);
    }
    void operator()(const char* name, const Eigen::VectorXd& v) {
        write_array(file, name, v.data(), static_cast<std::size_t>(v.size()));
    }
    void operator()(const char* name, const std::vector<double>& v) { write_array(file, name, v.data(), v.size()); }
    void operator()(const char* name, const std::vector<InterfaceStatus>& v) {
        std::vector<std::uint8_t> codes;
        for (const InterfaceStatus status : v) codes.push_back(static_cast<std::uint8_t>(status));
        write_array(file, name, codes.data(), codes.size());
    }
    /// Keys five integers each, histories two numbers each.
    void operator()(const char* name, const std::vector<ContactMemory>& v) {
        std::vector<int> keys;
        std::vector<double> histories;
        for (const auto& [key, history] : v) {
            keys.insert(keys.end(), {key.block_a, key.edge_a, key.block_b, key.edge_b, key.point});
            histories.insert(histories.end(), {history.shear_trial, history.dilation});
        }
        write_array(file, (std::string(name) + "_keys").c_str(), keys.data(), keys.size());
        write_array(file, (std::string(name) + "_histories").c_str(), histories.data(), histories.size());
    }
    /// Nine integers and 20 numbers each, without the history, which the load step begins with anyway.
    void operator()(const char* name, const std::vector<ContactPoint>& v) {
        std::vector<int> integers;
        std::vector<double> numbers;
        for (const ContactPoint& p : v) {
            integers.insert(integers.end(), {p.block_a, p.block_b, p.law, p.interface, p.key.block_a, p.key.edge_a,
                                             p.key.block_b, p.key.edge_b, p.key.point});
            for (const Vec2& x :
                 {p.xi_a, p.xi_b, p.offset, p.normal, p.tangent, p.piece.xi_a, p.piece.xi_b, p.piece.offset})
                numbers.insert(numbers.end(), {x.x(), x.y()});
            numbers.insert(numbers.end(), {p.piece.from, p.piece.to, p.weight, p.along});
        }
        write_array(file, (std::string(name) + "_integers").c_str(), integers.data(), integers.size());
        write_array(file, (std::string(name) + "_numbers").c_str(), numbers.data(), numbers.size());
    }
    /// Five integers and three numbers each.
    void operator()(const char* name, const std::vector<PlatenPoint>& v) {
        std::vector<int> keys;
        std::vector<double> numbers;
        for (const PlatenPoint& p : v) {
            keys.insert(keys.end(), {p.boundary, p.block, p.vertex, p.is_laid ? 1 : 0, static_cast<int>(p.contact)});
            numbers.insert(numbers.end(), {p.reach, p.along, p.friction});
        }
        write_array(file, (std::string(name) + "_keys").c_str(), keys.data(), keys.size());
        write_array(file, (std::string(name) + "_numbers").c_str(), numbers.data(), numbers.size());
    }
    /// Two integers and two numbers each.
    void operator()(const char* name, const std::vector<MovingBlock>& v) {
        std::vector<int> blocks;
        std::vector<double> directions;
        for (const auto& [block, direction, turn] : v) {
            blocks.insert(blocks.end(), {block, turn});
            directions.insert(directions.end(), {direction.x(), direction.y()});
        }
        write_array(file, (std::string(name) + "_blocks").c_str(), blocks.data(), blocks.size());
        write_array(file, (std::string(name) + "_directions").c_str(), directions.data(), directions.size());
    }
    void operator()(const char* name, const std::vector<std::pair<int, int>>& v) {
        std::vector<int> numbers;
        for (const auto& [a, b] : v) numbers.insert(numbers.end(), {a, b});
        write_array(file, name, numbers.data(), numbers.size());
    }
    void operator()(const char* name, const std::vector<int>& v) { write_array(file, name, v.data(), v.size()); }
    /// One after the other, each with an end of text.
    void operator()(const char* name, const std::vector<std::string>& v) {
        std::vector<std::uint8_t> bytes;
        for (const std::string& text : v) {
            bytes.insert(bytes.end(), text.begin(), text.end());
            bytes.push_back(0);
        }
        write_array(file, name, bytes.data(), bytes.size());
    }
};

/// Fetches the members of a state one by one.
struct Reader {
    hid_t file;

    void operator()(const char* name, int& value) { value = read_scalar<int>(file, name); }
    void operator()(const char* name, double& value) { value = read_scalar<double>(file, name); }
    void operator()(const char* name, bool& value) { value = read_scalar<int>(file, name) != 0; }
    void operator()(const char* name, Eigen::VectorXd& v) {
        const auto values = read_array<double>(file, name);
        v = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    }
    void operator()(const char* name, std::vector<double>& v) { v = read_array<double>(file, name); }
    void operator()(const char* name, std::vector<InterfaceStatus>& v) {
        v.clear();
        for (const std::uint8_t code : read_array<std::uint8_t>(file, name)) {
            if (code > static_cast<std::uint8_t>(InterfaceStatus::shear_crack)) throw Hdf5Failure{name};
            v.push_back(static_cast<InterfaceStatus>(code));
        }
    }
    void operator()(const char* name, std::vector<ContactMemory>& v) {
        const auto keys = read_array<int>(file, (std::string(name) + "_keys").c_str());
        const auto histories = read_array<double>(file, (std::string(name) + "_histories").c_str());
        if (keys.size() % 5 != 0 || keys.size() / 5 * 2 != histories.size()) throw Hdf5Failure{name};
        v.resize(keys.size() / 5);
        for (std::size_t i = 0; i < v.size(); ++i) {
            const int* const key = &keys[5 * i];
            v[i].key = {key[0], key[1], key[2], key[3], key[4]};
            v[i].history = {histories[2 * i], histories[2 * i + 1]};
        }
    }
    void operator()(const char* name, std::vector<ContactPoint>& v) {
        const auto integers = read_array<int>(file, (std::string(name) + "_integers").c_str());
        const auto numbers = read_array<double>(file, (std::string(name) + "_numbers").c_str());
        if (integers.size() % 9 != 0 || integers.size() / 9 * 20 != numbers.size()) throw Hdf5Failure{name};
        v.resize(integers.size() / 9);
        for (std::size_t i = 0; i < v.size(); ++i) {
            const int* k = &integers[9 * i];
            const double* x = &numbers[20 * i];
            ContactPoint& p = v[i];
            for (int* to : {&p.block_a, &p.block_b, &p.law, &p.interface, &p.key.block_a, &p.key.edge_a, &p.key.block_b,
                            &p.key.edge_b, &p.key.point})
                *to = *k++;
            for (Vec2* to :
                 {&p.xi_a, &p.xi_b, &p.offset, &p.normal, &p.tangent, &p.piece.xi_a, &p.piece.xi_b, &p.piece.offset}) {
                *to = Vec2(x[0], x[1]);
                x += 2;
            }
            for (double* to : {&p.piece.from, &p.piece.to, &p.weight, &p.along}) *to = *x++;
        }
    }
    void operator()(const char* name, std::vector<PlatenPoint>& v) {
        const auto keys = read_array<int>(file, (std::string(name) + "_keys").c_str());
        const auto numbers = read_array<double>(file, (std::string(name) + "_numbers").c_str());
        if (keys.size() % 5 != 0 || keys.size() / 5 * 3 != numbers.size()) throw Hdf5Failure{name};
        v.resize(keys.size() / 5);
        for (std::size_t i = 0; i < v.size(); ++i) {
            const int* const key = &keys[5 * i];
            const double* const number = &numbers[3 * i];
            if (key[4] < 0 || key[4] > static_cast<int>(PlatenContact::beyond)) throw Hdf5Failure{name};
            v[i] = {key[0],    key[1],    key[2],   key[3] != 0, static_cast<PlatenContact>(key[4]),
                    number[0], number[1], number[2]};
        }
    }
    void operator()(const char* name, std::vector<MovingBlock>& v) {
        const auto blocks = read_array<int>(file, (std::string(name) + "_blocks").c_str());
        const auto directions = read_array<double>(file, (std::string(name) + "_directions").c_str());
        if (blocks.size() % 2 != 0 || blocks.size() != directions.size()) throw Hdf5Failure{name};
        v.clear();
        for (std::size_t i = 0; i < blocks.size(); i += 2)
            v.push_back({blocks[i], Vec2(directions[i], directions[i + 1]), blocks[i + 1]});
    }
    void operator()(const char* name, std::vector<std::pair<int, int>>& v) {
        const auto numbers = read_array<int>(file, name);
        if (numbers.size() % 2 != 0) throw Hdf5Failure{name};
        v.clear();
        for (std::size_t i = 0; i < numbers.size(); i += 2) v.emplace_back(numbers[i], numbers[i + 1]);
    }
    void operator()(const char* name, std::vector<int>& v) { v = read_array<int>(file, name); }
    void operator()(const char* name, std::vector<std::string>& v) {
        v.clear();
        const auto bytes = read_array<std::uint8_t>(file, name);
        for (auto from = bytes.begin(); from != bytes.end();) {
            const auto end = std::find(from, bytes.end(), 0);
            if (end == bytes.end()) throw Hdf5Failure{name};
            v.emplace_back(from, end);
            from = end + 1;
        }
    }
};

void write_bytes(hid_t file, const char* name, const std::string& text) {
    write_array(file, name, std::vector<std::uint8_t>(text.begin(), text.end()).data(), text.size());
}

std::string file_image(const State& state, const std::string& fingerprint, const std::string& scene,
                       const std::string& tables) {
    const Identifier access = memory_access();
    const Identifier file(H5Fcreate("state", H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose, "no file");
    write_text(file, "format", format_name);
    write_text(file, "fingerprint", fingerprint);
    write_array(file, "format_version", &format_version, 1);
    write_bytes(file, "scene", scene);
    write_bytes(file, "tables", tables);
    visit_saved(state, Writer{file});
    checked(H5Fflush(file, H5F_SCOPE_GLOBAL), "not flushed");
    const ssize_t size = H5Fget_file_image(file, nullptr, 0);
    if (size <= 0) throw Hdf5Failure{"no image"};
    std::string image(static_cast<std::size_t>(size), '\0');
    if (H5Fget_file_image(file, image.data(), image.size()) != size) throw Hdf5Failure{"no image"};
    return image;
}

/// The image in the bytes of a state file. HDF5 itself crashes on some damaged files.
std::string_view unsealed(std::string_view bytes) {
    const std::size_t length = seal.size() + digest_digits + 1;
    if (bytes.size() < length || bytes.substr(bytes.size() - length, seal.size()) != seal)
        throw Hdf5Failure{"without the digest at its end"};
    const std::string_view image = bytes.substr(0, bytes.size() - length);
    if (bytes.substr(image.size() + seal.size()) != Digest().add(image).text() + "\n")
        throw Hdf5Failure{"changed since it was saved"};
    return image;
}

/// Calls read(file) with the file of a state, after a look at its format and version.
template <class Read> auto read_image(const std::filesystem::path& path, Read&& read) {
    const SilentErrors silent;
    const std::string place = path.string();
    const std::string bytes = read_file(path);
    try {
        const std::string_view image = unsealed(bytes);
        const Identifier access = memory_access();
        checked(H5Pset_file_image(access, const_cast<char*>(image.data()), image.size()),
                "no image"); // which it copies
        const Identifier file(H5Fopen("state", H5F_ACC_RDONLY, access), H5Fclose, "not a whole HDF5 file");
        if (read_text(file, "format") != format_name) throw Hdf5Failure{"no state in it"};
        const int version = read_scalar<int>(file, "format_version");
        if (version != format_version)
            throw InputError(place + ": expected a state of version " + std::to_string(format_version) + ", found " +
                             std::to_string(version));
        return read(file);
    } catch (const Hdf5Failure& failure) {
        throw InputError(place + ": expected a saved state, found a damaged or foreign file (" + failure.what + ")");
    }
}

State state_in(hid_t file, const std::string& place, const std::string& expected_fingerprint) {
    if (read_text(file, "fingerprint") != expected_fingerprint)
        throw InputError(place + ": belongs to another scene, or the scene was changed since it was saved");
    State state;
    visit_saved(state, Reader{file});
    return state;
}

/// A text that earlier versions did not save.
std::string read_bytes(const std::filesystem::path& path, const char* name, const std::string& what) {
    return read_image(path, [&](hid_t file) {
        if (H5Lexists(file, name, H5P_DEFAULT) <= 0)
            throw InputError(path.string() + ": holds no " + what + "; it was saved by an earlier version");
        const auto bytes = read_array<std::uint8_t>(file, name);
        return std::string(bytes.begin(), bytes.end());
    });
}

} // namespace

std::string sealed(std::string image) {
    const std::string digest = Digest().add(image).text();
    return std::move(image.append(seal).append(digest).append("\n"));
}

void write_state(const std::filesystem::path& path, const State& state, const std::string& fingerprint,
                 const std::string& scene, const std::string& tables) {
    const SilentErrors silent;
    try {
        write_file(path, sealed(file_image(state, fingerprint, scene, tables)));
    } catch (const Hdf5Failure& failure) {
        throw ResourceError(path.string() + ": cannot store the state in memory: " + failure.what);
    }
}

State read_state(const std::filesystem::path& path, const std::string& expected_fingerprint) {
    return read_image(path, [&](hid_t file) { return state_in(file, path.string(), expected_fingerprint); });
}

std::string read_state_fingerprint(const std::filesystem::path& path) {
    return read_image(path, [](hid_t file) { return read_text(file, "fingerprint"); });
}

std::string read_state_scene(const std::filesystem::path& path) { return read_bytes(path, "scene", "scene"); }

std::string read_state_tables(const std::filesystem::path& path) {
    return read_bytes(path, "tables", "record of the tables");
}

} // namespace kluft
