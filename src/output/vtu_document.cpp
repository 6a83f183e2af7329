#include "vtu_document.hpp"

#include <bit>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace kluft {

VtuDocument::VtuDocument(std::size_t n_points, std::size_t n_cells) : n_points_(n_points), n_cells_(n_cells) {
    constexpr std::size_t xml_bytes = 16384;
    constexpr std::size_t bytes_per_point = 56; // place, motion, index
    constexpr std::size_t bytes_per_cell = 64;
    appended_.reserve(xml_bytes + bytes_per_point * n_points + bytes_per_cell * n_cells);
}

std::vector<double> VtuDocument::finite(const std::vector<double>& values) {
    std::vector<double> checked = values;
    for (double& value : checked) {
        if (std::isfinite(value)) continue;
        value = 0.0;
        ++n_replaced_;
    }
    return checked;
}

void VtuDocument::add_array(std::string& section, std::string_view attributes, const void* bytes, std::size_t size) {
    section += fmt::format("<DataArray {} format=\"appended\" offset=\"{}\"/>\n", attributes, appended_.size());
    const std::uint64_t length = size;
    appended_.append(reinterpret_cast<const char*>(&length), sizeof length);
    appended_.append(static_cast<const char*>(bytes), size);
}

void VtuDocument::add_points(const std::vector<double>& xyz) {
    const auto values = finite(xyz);
    add_array(points_, R"(type="Float64" Name="Points" NumberOfComponents="3")", values.data(),
              values.size() * sizeof(double));
}

void VtuDocument::add_cells(const std::vector<std::int64_t>& connectivity, const std::vector<std::int64_t>& ends,
                            std::uint8_t type) {
    const std::vector<std::uint8_t> types(n_cells_, type);
    add_array(cells_, R"(type="Int64" Name="connectivity")", connectivity.data(),
              connectivity.size() * sizeof(std::int64_t));
    add_array(cells_, R"(type="Int64" Name="offsets")", ends.data(), ends.size() * sizeof(std::int64_t));
    add_array(cells_, R"(type="UInt8" Name="types")", types.data(), types.size());
}

void VtuDocument::add_point_vectors(std::string_view name, const std::vector<double>& xyz) {
    const auto values = finite(xyz);
    add_array(point_data_, fmt::format(R"(type="Float64" Name="{}" NumberOfComponents="3")", name), values.data(),
              values.size() * sizeof(double));
}

void VtuDocument::add_cell_field(std::string_view name, const std::vector<double>& values) {
    const auto checked = finite(values);
    add_array(cell_data_, fmt::format(R"(type="Float64" Name="{}")", name), checked.data(),
              checked.size() * sizeof(double));
}

void VtuDocument::add_cell_field(std::string_view name, const std::vector<std::int32_t>& values) {
    add_array(cell_data_, fmt::format(R"(type="Int32" Name="{}")", name), values.data(),
              values.size() * sizeof(std::int32_t));
}

void VtuDocument::add_field(std::string_view name, double value) {
    const double checked = finite({value}).front();
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
