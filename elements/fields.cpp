#include "elements/fields.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <cstring>

#include "runs/folder.h"
#include "runs/run_directory.h"

namespace flowrest::elements {

namespace {

/// VTK_BIQUADRATIC_QUAD: corners, middles of sides, centre, each about the element; and our node there.
constexpr std::uint8_t biquadratic_quad = 28;
constexpr int vtk_node[element_nodes] = {0, 6, 8, 2, 3, 7, 5, 1, 4};

/// The binary part of a file: arrays one after the other, each after its length in bytes.
class Appended {
 public:
  /// Adds an array and gives the element that names it.
  template <class T>
  std::string array(const std::string& name, const char* type, int components, const std::vector<T>& values) {
    const std::string element = fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n",
        type, name, components, data_.size());
    const auto bytes = static_cast<std::uint32_t>(values.size() * sizeof(T));
    append(&bytes, sizeof bytes);
    append(values.data(), bytes);
    return element;
  }
  const std::string& data() const { return data_; }

 private:
  void append(const void* from, std::size_t bytes) { data_.append(static_cast<const char*>(from), bytes); }
  std::string data_;
};

std::vector<float> in_section(const Field& field) {
  std::vector<float> values;
  for (Eigen::Index i = 0; i < field.cols(); ++i)
    for (const double x : {field(0, i), 0.0, field(1, i)}) values.push_back(static_cast<float>(x));
  return values;
}

std::vector<float> floats(const Eigen::VectorXd& values) {
  const Eigen::VectorXf narrow = values.cast<float>();
  return {narrow.begin(), narrow.end()};
}

}  // namespace

std::string vtu_of(const Slump& slump) {
  const Mesh& mesh = slump.mesh();
  const Topology& topology = mesh.topology;
  std::vector<std::int32_t> connectivity, offset;
  for (int c = 0; c < topology.columns; ++c)
    for (int r = 0; r < topology.rows; ++r) {
      for (const int a : vtk_node) connectivity.push_back(topology.element_node(c, r, a));
      offset.push_back(static_cast<std::int32_t>(connectivity.size()));
    }
  const std::vector<std::uint8_t> types(offset.size(), biquadratic_quad);
  Appended appended;
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"{}\" "
      "header_type=\"UInt32\">\n<UnstructuredGrid>\n<FieldData>\n<DataArray type=\"Float64\" "
      "Name=\"TimeValue\" "
      "NumberOfTuples=\"1\" format=\"ascii\">{:.17g}</DataArray>\n</FieldData>\n<Piece NumberOfPoints=\"{}\" "
      "NumberOfCells=\"{}\">\n",
      std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian", slump.time(),
      topology.nodes(), topology.elements());
  text += "<PointData>\n" + appended.array("velocity", "Float32", 3, in_section(slump.velocity())) +
          appended.array("pressure", "Float32", 1, floats(slump.flow().node_pressures(mesh.position))) +
          appended.array("shear_rate", "Float32", 1, floats(slump.flow().node_rates(slump.velocity()))) +
          "</PointData>\n<Points>\n" + appended.array("points", "Float32", 3, in_section(mesh.position)) +
          "</Points>\n<Cells>\n" + appended.array("connectivity", "Int32", 1, connectivity) +
          appended.array("offsets", "Int32", 1, offset) + appended.array("types", "UInt8", 1, types) +
          "</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";
  return text + appended.data() + "\n</AppendedData>\n</VTKFile>\n";
}

void FieldWriter::write(const Slump& slump) {
  if (series_.empty()) runs::make_folder(directory_);
  series_.emplace_back(fmt::format("fields_{:06}.vtu", series_.size()), slump.time());
  runs::write_atomically(directory_ / series_.back().first, vtu_of(slump));
  std::string index =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
  for (const auto& [name, time] : series_)
    index += fmt::format("<DataSet timestep=\"{:.17g}\" file=\"{}\"/>\n", time, name);
  runs::write_atomically(directory_ / "fields.pvd", index + "</Collection>\n</VTKFile>\n");
}

}  // namespace flowrest::elements
