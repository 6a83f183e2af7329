#include "vtu_document.hpp"

#include <bit>
#include <cmath>
#include <new>
#include <utility>

#include <fmt/format.h>
#include <zlib.h>

namespace kluft {

namespace {

constexpr std::size_t piece_bytes = 1U << 20U; ///< a multiple of the size of every number
constexpr int compression = 1;                 ///< of 1 to 9: more takes longer and saves nothing

std::string xml_text(std::string_view text) {
    std::string result;
    for (const char c : text) {
        if (c == '&')
            result += "&amp;";
        else if (c == '<')
            result += "&lt;";
        else if (c == '"')
            result += "&quot;";
        else if (static_cast<unsigned char>(c) < ' ')
            result += ' ';
        else
            result += c;
    }
    return result;
}

} // namespace

VtuDocument::VtuDocument(std::size_t n_points, std::size_t n_cells) : n_points_(n_points), n_cells_(n_cells) {}

void VtuDocument::append(const void* bytes, std::size_t size) {
    piece_.append(static_cast<const char*>(bytes), size);
    if (piece_.size() == piece_bytes) compress_piece();
}

void VtuDocument::compress_piece() {
    const std::size_t before = appended_.size();
    uLongf size = ::compressBound(piece_.size());
    appended_.resize(before + size);
    const int result = ::compress2(reinterpret_cast<Bytef*>(&appended_[before]), &size, // NOLINT: bytes are bytes
                                   reinterpret_cast<const Bytef*>(piece_.data()), piece_.size(), compression);
    if (result != Z_OK) throw std::bad_alloc();
    appended_.resize(before + size);
    n_bytes_.push_back(size);
    piece_.clear();
}

/// Puts the header before the pieces: their number, the size of a piece and of a last one that is smaller, and the sizes when
/// compressed.
void VtuDocument::end_array() {
    if (!array_at_) return;
    const std::uint64_t of_last = piece_.size();
    if (!piece_.empty()) compress_piece();
    std::vector<std::uint64_t> header{n_bytes_.size(), piece_bytes, of_last};
    header.insert(header.end(), n_bytes_.begin(), n_bytes_.end());
    appended_.insert(*array_at_, reinterpret_cast<const char*>(header.data()), // NOLINT: bytes are bytes
                     header.size() * sizeof(std::uint64_t));
    n_bytes_.clear();
}

void VtuDocument::Array::put(double number) {
    const double checked = document_.finite(number);
    append(&checked, sizeof checked);
}

void VtuDocument::Array::put(const Vec2& vector) {
    put(vector.x());
    put(vector.y());
    put(0.0);
}

void VtuDocument::Array::put(const Mat2& tensor, double across) {
    for (int row = 0; row < 2; ++row) put(Vec2(tensor.row(row)));
    for (const double number : {0.0, 0.0, across}) put(number);
}

double VtuDocument::finite(double number) {
    if (std::isfinite(number)) return number;
    ++n_replaced_;
    return 0.0;
}

VtuDocument::Array VtuDocument::begin(std::string& section, std::string_view attributes) {
    end_array();
    array_at_ = appended_.size();
    section += fmt::format("<DataArray {} format=\"appended\" offset=\"{}\"/>\n", attributes, appended_.size());
    return Array(*this);
}

VtuDocument::Array VtuDocument::points() {
    return begin(points_, R"(type="Float64" Name="Points" NumberOfComponents="3")");
}

VtuDocument::Array VtuDocument::point_vectors(std::string_view name) {
    return begin(point_data_, fmt::format(R"(type="Float64" Name="{}" NumberOfComponents="3")", name));
}

VtuDocument::Array VtuDocument::connectivity() { return begin(cells_, R"(type="Int64" Name="connectivity")"); }
VtuDocument::Array VtuDocument::ends() { return begin(cells_, R"(type="Int64" Name="offsets")"); }
VtuDocument::Array VtuDocument::types() { return begin(cells_, R"(type="UInt8" Name="types")"); }

VtuDocument::Array VtuDocument::cell_tensors(std::string_view name) {
    return begin(cell_data_, fmt::format(R"(type="Float64" Name="{}" NumberOfComponents="9")", name));
}

VtuDocument::Array VtuDocument::cell_vectors(std::string_view name) {
    return begin(cell_data_, fmt::format(R"(type="Float64" Name="{}" NumberOfComponents="3")", name));
}

VtuDocument::Array VtuDocument::cell_field(std::string_view name, std::string_view type) {
    return begin(cell_data_, fmt::format(R"(type="{}" Name="{}")", type, name));
}

void VtuDocument::add_field(std::string_view name, double value) {
    const double checked = finite(value);
    field_data_ +=
        fmt::format("<DataArray type=\"Float64\" Name=\"{}\" NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>\n",
                    xml_text(name), checked);
}

void VtuDocument::add_field(std::string_view name, std::int32_t value) {
    field_data_ +=
        fmt::format("<DataArray type=\"Int32\" Name=\"{}\" NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>\n",
                    xml_text(name), value);
}

std::string VtuDocument::content() {
    end_array();
    array_at_.reset();
    add_field("replaced_values", n_replaced_);
    const std::string_view order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
    std::string text = std::move(appended_); // large: the rest goes around it
    text.insert(0, fmt::format("<?xml version=\"1.0\"?>\n"
                               "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"{}\" "
                               "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n"
                               "<UnstructuredGrid>\n<FieldData>\n{}</FieldData>\n"
                               "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n"
                               "<PointData>\n{}</PointData>\n<CellData>\n{}</CellData>\n"
                               "<Points>\n{}</Points>\n<Cells>\n{}</Cells>\n"
                               "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_",
                               order, field_data_, n_points_, n_cells_, point_data_, cell_data_, points_, cells_));
    text += "\n</AppendedData>\n</VTKFile>\n";
    return text;
}

} // namespace kluft
