#include "foamCases/case_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "foamCases/field_file.h"

namespace flowrest::foam {

namespace fs = std::filesystem;

namespace {

fs::path part(const fs::path& case_directory, int rank) {
  return case_directory / fmt::format("processor{}", rank);
}

}  // namespace

std::vector<std::pair<double, fs::path>> time_directories(const fs::path& folder) {
  std::vector<std::pair<double, fs::path>> found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    double time = 0.0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), time);
    if (error == std::errc{} && end == name.data() + name.size() && entry.is_directory())
      found.emplace_back(time, entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

CaseFields::CaseFields(fs::path case_directory, int ranks) {
  if (ranks <= 1) {
    parts_.push_back(std::move(case_directory));
  } else {
    for (int rank = 0; rank < ranks; ++rank) parts_.push_back(part(case_directory, rank));
  }
}

int CaseFields::ranks_in(const fs::path& case_directory) {
  int ranks = 0;
  while (fs::is_directory(part(case_directory, ranks))) ++ranks;
  return std::max(ranks, 1);
}

std::vector<std::pair<double, std::string>> CaseFields::times() const {
  std::vector<std::pair<double, std::string>> found;
  for (const auto& [time, directory] : time_directories(parts_.front())) {
    const std::string name = directory.filename().string();
    if (std::all_of(parts_.begin(), parts_.end(),
                    [&](const fs::path& folder) { return fs::is_directory(folder / name); }))
      found.emplace_back(time, name);
  }
  return found;
}

std::vector<double> CaseFields::read(const std::string& time, const std::string& field, std::size_t cells,
                                     int components) const {
  if (parts_.size() == 1) return read_internal_field(parts_.front() / time / field, cells, components);
  const auto width = static_cast<std::size_t>(components);
  std::vector<double> whole(cells * width);
  for (const auto& folder : parts_) {
    const auto addresses = read_labels(folder / "constant" / "polyMesh" / "cellProcAddressing");
    const auto values = read_internal_field(folder / time / field, addresses.size(), components);
    for (std::size_t i = 0; i < addresses.size(); ++i) {
      const auto cell = static_cast<std::size_t>(addresses[i]);
      if (addresses[i] < 0 || cell >= cells)
        throw FieldError(fmt::format("{}: its cell {} is none of the {} of the mesh", folder.string(),
                                     addresses[i], cells));
      std::copy_n(&values[i * width], width, &whole[cell * width]);
    }
  }
  return whole;
}

bool CaseFields::holds(const std::string& time, const std::string& field) const {
  return std::all_of(parts_.begin(), parts_.end(),
                     [&](const fs::path& folder) { return fs::exists(folder / time / field); });
}

void CaseFields::remove(const std::string& time) const {
  for (const auto& folder : parts_) fs::remove_all(folder / time);
}

}  // namespace flowrest::foam
