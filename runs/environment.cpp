#include "runs/environment.h"

#include <unistd.h>

#include "runs/folder.h"
#include "runs/temporary_folder.h"

extern char** environ;

namespace flowrest::runs {

namespace fs = std::filesystem;

namespace {

const fs::path& private_home() {
  static const TemporaryFolder home(TemporaryFolder::Name::plain);
  return home.path();
}

}  // namespace

std::map<std::string, std::string> own_environment() {
  std::map<std::string, std::string> entries;
  for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
    const std::string text(*entry);
    const auto equals = text.find('=');
    if (equals != std::string::npos) entries.emplace(text.substr(0, equals), text.substr(equals + 1));
  }
  return entries;
}

std::vector<std::string> texts_of(const std::map<std::string, std::string>& entries) {
  std::vector<std::string> texts;
  for (const auto& [name, value] : entries) texts.push_back(name + "=" + value);
  return texts;
}

std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

Environment Environment::of_helper() {
  return with_home(private_home()).set("TMPDIR", private_home().string());
}

Environment Environment::with_home(const fs::path& home) {
  make_folder(home);
  return Environment(Home{home});
}

Environment::Environment(const Home& place) {
  const fs::path& home = place.path;
  set("PATH", "/usr/local/bin:/usr/bin:/bin");
  // Where programs lie and who asks; what a scheduler says of this job and needs for others; what we are told
  // ourselves, for where a helper calls this program again.
  for (const char* beginning : {"PATH=", "USER=", "LOGNAME=", "SLURM", "SBATCH_", "FLOWREST_"})
    keep(beginning);
  set("HOME", home.string());
  set("XDG_CONFIG_HOME", (home / ".config").string());
  set("XDG_CACHE_HOME", (home / ".cache").string());
  set("XDG_DATA_HOME", (home / ".local" / "share").string());
  set("LANG", "C.UTF-8");
  set("LC_ALL", "C.UTF-8");
}

Environment& Environment::set(const std::string& name, const std::string& value) {
  entries_[name] = value;
  return *this;
}

Environment& Environment::keep(const std::string& beginning) {
  for (const auto& [name, value] : own_environment())
    if ((name + "=").starts_with(beginning)) entries_[name] = value;
  return *this;
}

}  // namespace flowrest::runs
