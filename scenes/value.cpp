#include "scenes/value.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "scenes/scene.h"

namespace flowrest::scenes {

std::string Location::text() const {
  return line == 0 ? source : fmt::format("{}:{}:{}", source, line, column);
}

std::string Value::what() const {
  struct Namer {
    std::string operator()(const Foreign& foreign) const { return foreign.what; }
    std::string operator()(bool) const { return "a boolean"; }
    std::string operator()(std::int64_t) const { return "an integer"; }
    std::string operator()(double) const { return "a number"; }
    std::string operator()(const std::string&) const { return "a string"; }
    std::string operator()(const std::vector<Value>&) const { return "an array"; }
  };
  return std::visit(Namer{}, content);
}

Location Given::place_of(const std::string& path) const {
  if (const auto value = values.find(path); value != values.end()) return value->second.where;
  const auto section = sections.find(path.substr(0, path.find('.')));
  return section == sections.end() ? start : section->second;
}

void Faults::add(const Location& where, const std::string& what) { faults_.push_back({what, where}); }

void Faults::raise() const {
  if (faults_.empty()) return;
  // By line within each source; sources in the order in which they were first found at fault.
  std::vector<std::string> sources;
  for (const Complaint& fault : faults_) {
    if (std::find(sources.begin(), sources.end(), fault.where.source) == sources.end()) {
      sources.push_back(fault.where.source);
    }
  }
  auto place = [&](const Complaint& fault) {
    return std::tuple(std::find(sources.begin(), sources.end(), fault.where.source), fault.where.line,
                      fault.where.column);
  };
  std::vector<Complaint> sorted = faults_;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](const Complaint& a, const Complaint& b) { return place(a) < place(b); });

  constexpr std::size_t most = 50;
  std::string message;
  for (std::size_t i = 0; i < std::min(sorted.size(), most); ++i) {
    message += fmt::format("{}{}: {}", i == 0 ? "" : "\n", sorted[i].where.text(), sorted[i].what);
  }
  if (sorted.size() > most) message += fmt::format("\n... and {} more faults", sorted.size() - most);
  throw SceneError(message);
}

}  // namespace flowrest::scenes
