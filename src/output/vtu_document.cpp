#include "vtu_document.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include <fmt/format.h>

namespace kluft {

VtuDocument::VtuDocument(std::size_t n_points, std::size_t n_cells) : n_points_(n_points), n_cells_(n_cells) {
    constexpr std::size_t xml_bytes = 16384;
    constexpr std::size_t bytes_per_point = 56; // place, motion, index
    constexpr std::size_t bytes_per_cell = 64;
    appended_.reserve(xml_bytes + bytes_per_point * n_points + bytes_per_cell * n_cells);
}

VtuDocument::Array::Array(VtuDocument& document) : document_(document), begin_(document.appended_.size()) {
    constexpr std::uint64_t length_to_come = 0;
    append(&length_to_come, sizeof length_to_come);
}

VtuDocument::Array::~Array() {
    const std::uint64_t length = document_.appended_.size() - begin_ - sizeof length;
    std::memcpy(&document_.appended_[begin_], &length, sizeof length);
}

void VtuDocument::Array::append(const void* bytes, std::size_t size) {
    document_.appended_.append(static_cast<const char*>(bytes), size);
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

void VtuDocument::Array::put(const Mat2& tensor) {
    for (int row = 0; row < 2; ++row) put(Vec2(tensor.row(row)));
    put(Vec2(0.0, 0.0));
}

double VtuDocument::finite(double number) {
    if (std::isfinite(number)) return number;
    ++n_replaced_;
    return 0.0;
}

VtuDocument::Array VtuDocument::begin(std::string& section, std::string_view attributes) {
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

VtuDocument::Array VtuDocument::cell_field(std::string_view name, std::string_view type) {
    return begin(cell_data_, fmt::format(R"(type="{}" Name="{}")", type, name));
}

void VtuDocument::add_field(std::string_view name, double value) {
    const double checked = finite(value);
    field_data_ +=
        fmt::format("<DataArray type=\"Float64\" Name=\"{}\" NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>\n",
                    name, checked);
}

void VtuDocument::add_field(std::string_view name, std::int32_t value) {
    field_data_ += fmt::format(
        "<DataArray type=\"Int32\" Name=\"{}\" NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>\n", name, value);
}

void VtuDocument::add_field(std::string_view name, const std::vector<std::string>& texts) {
    field_data_ += fmt::format("<DataArray type=\"String\" Name=\"{}\" NumberOfTuples=\"{}\" format=\"ascii\">", name,
                               texts.size());
    for (const std::string& text : texts) {
        for (const char character : text)
            field_data_ += fmt::format("{} ", static_cast<int>(static_cast<unsigned char>(character)));
        field_data_ += "0 ";
    }
    field_data_ += "</DataArray>\n";
}

std::string VtuDocument::content() {
    add_field("replaced_values", n_replaced_);
    const std::string_view order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
    std::string text = std::move(appended_); // large: the rest goes around it
    text.insert(0, fmt::format("<?xml version=\"1.0\"?>\n"
                               "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"{}\" "
                               "header_type=\"UInt64\">\n"
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
