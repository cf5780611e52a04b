#include "runs/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>

#include "runs/run_directory.h"

extern char** environ;

namespace flowrest::runs {

namespace fs = std::filesystem;

namespace {

volatile sig_atomic_t interrupts = 0;
struct sigaction earlier_int, earlier_term;

void note_interrupt(int) { interrupts = interrupts + 1; }

std::vector<std::string> merged_environment(const std::map<std::string, std::string>& added) {
  std::vector<std::string> merged;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text(*entry);
    if (!added.contains(text.substr(0, text.find('=')))) merged.push_back(text);
  }
  for (const auto& [name, value] : added) merged.push_back(name + "=" + value);
  return merged;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  for (auto& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

/// In the child, between fork and exec: only calls that are safe there. Returns where something fails.
void become(const char* program, char** arguments, char** environment, const char* directory, int log,
            pid_t parent) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) return;
  // A caller's ignored or noted signals are not the child's.
  signal(SIGINT, SIG_DFL);
  signal(SIGTERM, SIG_DFL);
  const int nothing = open("/dev/null", O_RDONLY);
  if (nothing < 0 || dup2(nothing, 0) < 0 || dup2(log, 1) < 0 || dup2(log, 2) < 0) return;
  if (chdir(directory) != 0) return;
  execve(program, arguments, environment);
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

std::optional<fs::path> find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path candidate = fs::path(folder.empty() ? "." : folder) / name;
    std::error_code error;
    if (fs::is_regular_file(candidate, error) && access(candidate.c_str(), X_OK) == 0)
      return fs::absolute(candidate);
  }
  return std::nullopt;
}

std::string last_words(const fs::path& log) {
  std::ifstream file(log);
  std::string last;
  for (std::string line; std::getline(file, line);)
    if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
  const std::string prefix = "flowrest: ";
  return last.starts_with(prefix) ? last.substr(prefix.size()) : last;
}

std::string ProcessEnd::how() const {
  return signal != 0 ? fmt::format("signal {} ({})", signal, strsignal(signal))
                     : fmt::format("exit code {}", exit_code);
}

Process::Process(const fs::path& program, const std::vector<std::string>& arguments,
                 const fs::path& directory, const fs::path& log,
                 const std::map<std::string, std::string>& environment) {
  std::vector<std::string> argument_texts{program.filename().string()};
  argument_texts.insert(argument_texts.end(), arguments.begin(), arguments.end());
  auto environment_texts = merged_environment(environment);
  const auto argument_pointers = pointers(argument_texts);
  const auto environment_pointers = pointers(environment_texts);
  const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) throw RunError(fmt::format("{}: cannot be written: {}", log.string(), std::strerror(errno)));
  int word[2];  // by which the child says why it has not become the program; closed by its becoming it
  if (pipe2(word, O_CLOEXEC) != 0) {
    close(file);
    throw RunError(fmt::format("{}: cannot be started: {}", program.string(), std::strerror(errno)));
  }
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) {
    become(program.c_str(), const_cast<char**>(argument_pointers.data()),
           const_cast<char**>(environment_pointers.data()), directory.c_str(), file, parent);
    const int reason = errno;
    const bool told = write(word[1], &reason, sizeof reason) == static_cast<ssize_t>(sizeof reason);
    _exit(told ? 127 : 126);
  }
  int reason = pid_ < 0 ? errno : 0;
  close(file);
  close(word[1]);
  while (pid_ > 0 && read(word[0], &reason, sizeof reason) < 0 && errno == EINTR) continue;
  close(word[0]);
  if (reason != 0) {
    if (pid_ > 0) waitpid(pid_, nullptr, 0);
    throw MissingProgram(fmt::format("{}: cannot be started: {}", program.string(), std::strerror(reason)));
  }
  setpgid(pid_, pid_);  // also here: whichever of the two comes first
}

Process::~Process() {
  if (end_ || pid_ <= 0) return;
  signal(SIGKILL);
  waitpid(pid_, nullptr, 0);
}

std::optional<ProcessEnd> Process::poll() {
  if (end_) return end_;
  int status = 0;
  rusage usage{};
  if (wait4(pid_, &status, WNOHANG, &usage) != pid_) return std::nullopt;
  ProcessEnd end;
  end.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
  end.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  end.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  end_ = end;
  return end_;
}

std::optional<ProcessEnd> Process::wait(double longest) {
  const auto start = std::chrono::steady_clock::now();
  while (!poll()) {
    const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - start;
    if (waited.count() >= longest) return std::nullopt;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return end_;
}

void Process::signal(int number) {
  if (!end_ && pid_ > 0) kill(-pid_, number);
}

InterruptGuard::InterruptGuard() {
  interrupts = 0;
  struct sigaction action {};
  action.sa_handler = note_interrupt;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, &earlier_int);
  sigaction(SIGTERM, &action, &earlier_term);
}

InterruptGuard::~InterruptGuard() {
  sigaction(SIGINT, &earlier_int, nullptr);
  sigaction(SIGTERM, &earlier_term, nullptr);
}

int InterruptGuard::count() { return interrupts; }

}  // namespace flowrest::runs
