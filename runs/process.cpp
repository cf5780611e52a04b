#include "runs/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <thread>

#include "runs/errors.h"
#include "runs/machine.h"

namespace flowrest::runs {

namespace fs = std::filesystem;

namespace {

constexpr std::array asking_to_stop = {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXCPU, SIGUSR1};
constexpr std::int64_t together = 700'000'000;  // ns: of signals that say the same

volatile sig_atomic_t interrupts = 0;
std::atomic<std::int64_t> last_interrupt = 0;  // ns
std::atomic<bool> nobody_reads = false;
static_assert(std::atomic<std::int64_t>::is_always_lock_free, "a signal's handler may use no other");

int guards = 0;
std::array<struct sigaction, asking_to_stop.size()> earlier_actions;

void note_interrupt(int number) {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  const std::int64_t at = std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
  // Every further word would bring this one again, every further second of CPU time the other.
  const bool again = number == SIGPIPE ? nobody_reads.exchange(true) : number == SIGXCPU && interrupts > 0;
  if (again || (interrupts > 0 && at - last_interrupt < together)) return;
  last_interrupt = at;
  interrupts = interrupts + 1;
}

/// By which a process is known as started by us, directly or not: the marks of all that it descends from.
constexpr const char* marks = "FLOWREST_STARTED_BY";
/// Which job of Slurm a process belongs to.
constexpr const char* slurm_job = "SLURM_JOB_ID";
/// How long what was asked twice may take to end.
constexpr std::chrono::seconds patience{5};

/// Of all processes that there are or will be, on this machine.
std::string new_mark() {
  static std::atomic<int> count = 0;
  return fmt::format("/{}-{}-{}/", getpid(), std::chrono::system_clock::now().time_since_epoch().count(),
                     ++count);
}

std::string value_of(const std::map<std::string, std::string>& environment, const char* name) {
  const auto found = environment.find(name);
  return found == environment.end() ? "" : found->second;
}

/// What a process was told when it was started; empty for the dead that wait for their parent.
std::map<std::string, std::string> environment_of(const fs::path& process) {
  std::map<std::string, std::string> entries;
  std::ifstream file(process / "environ", std::ios::binary);
  for (std::string entry; std::getline(file, entry, '\0');)
    if (const auto equals = entry.find('='); equals != std::string::npos)
      entries.emplace(entry.substr(0, equals), entry.substr(equals + 1));
  return entries;
}

/// The parent of a process; nothing where that has ended.
std::optional<pid_t> parent_of(const fs::path& process) {
  std::ifstream file(process / "stat");
  std::string text;
  std::getline(file, text);
  const auto name_ends = text.rfind(')');  // the name may hold anything
  if (name_ends == std::string::npos) return std::nullopt;
  std::istringstream rest(text.substr(name_ends + 1));
  std::string state;
  pid_t parent = 0;
  if (!(rest >> state >> parent) || state == "Z") return std::nullopt;
  return parent;
}

/// The processes that carry a mark, and all that descend from them: some hide what they were told. Jobs that
/// a scheduler runs for us carry it, too, but belong to the scheduler.
std::set<pid_t> family_of(const std::string& mark) {
  const std::string job = value_of(own_environment(), slurm_job);
  std::set<pid_t> family;
  std::map<pid_t, pid_t> parents;
  std::error_code error;
  for (fs::directory_iterator entry("/proc", error), end; !error && entry != end; entry.increment(error)) {
    const pid_t pid = std::atoi(entry->path().filename().c_str());
    const auto parent = pid > 0 ? parent_of(entry->path()) : std::nullopt;
    if (!parent) continue;
    const auto told = environment_of(entry->path());
    const bool marked = value_of(told, marks).find(mark) != std::string::npos;
    if (marked && value_of(told, slurm_job) != job) continue;
    parents[pid] = *parent;
    if (marked) family.insert(pid);
  }
  for (std::size_t before = 0; before != family.size();) {
    before = family.size();
    for (const auto& [pid, parent] : parents)
      if (family.contains(parent)) family.insert(pid);
  }
  return family;
}

/// In the child, between fork and exec: only calls that are safe there. Returns where something fails.
void become(const char* program, char** arguments, char** environment, const char* directory, int log,
            pid_t parent) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) return;
  // It has a group of its own, which no terminal interrupts: what it is sent, we mean.
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

bool ProcessEnd::from_outside() const {
  constexpr std::array sent_by_others = {SIGKILL, SIGTERM, SIGINT, SIGHUP, SIGXCPU, SIGXFSZ};
  const int number = signal != 0 ? signal : exit_code - 128;
  return std::find(sent_by_others.begin(), sent_by_others.end(), number) != sent_by_others.end();
}

Process::Process(const fs::path& program, const std::vector<std::string>& arguments,
                 const fs::path& directory, const fs::path& log, const Environment& environment) {
  start(program, arguments, directory, log, environment.entries());
}

Process::Process(const fs::path& program, const std::vector<std::string>& arguments,
                 const fs::path& directory, const fs::path& log,
                 const std::map<std::string, std::string>& added) {
  auto environment = own_environment();
  for (const auto& [name, value] : added) environment[name] = value;
  start(program, arguments, directory, log, std::move(environment));
}

void Process::start(const fs::path& program, const std::vector<std::string>& arguments,
                    const fs::path& directory, const fs::path& log,
                    std::map<std::string, std::string> environment) {
  mark_ = new_mark();
  environment[marks] += mark_;
  environment["PWD"] = fs::absolute(directory).string();
  std::vector<std::string> argument_texts{program.filename().string()};
  argument_texts.insert(argument_texts.end(), arguments.begin(), arguments.end());
  auto environment_texts = texts_of(environment);
  const auto argument_pointers = pointers_to(argument_texts);
  const auto environment_pointers = pointers_to(environment_texts);
  const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) cannot_be_written(log, errno);
  int word[2];  // by which the child says why it has not become the program; closed by its becoming it
  if (pipe2(word, O_CLOEXEC) != 0) {
    close(file);
    throw MachineError(fmt::format("{}: cannot be started: {}", program.string(), std::strerror(errno)));
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
    const std::string what =
        fmt::format("{}: cannot be started: {}", program.string(), std::strerror(reason));
    if (machine_is_at_fault(reason)) throw MachineError(what);
    throw MissingProgram(what);
  }
  setpgid(pid_, pid_);  // also here: whichever of the two comes first
}

Process::~Process() {
  if (pid_ > 0) kill_all();
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

bool Process::hand_on_interrupts() {
  const auto now = std::chrono::steady_clock::now();
  for (const int asked = InterruptGuard::count(); handed_on_ < asked; ++handed_on_) {
    signal(SIGINT);
    if (handed_on_ == 1) deadline_ = now + patience;
    if (handed_on_ > 1) deadline_ = now;
  }
  if (deadline_ && now >= *deadline_) kill_all();
  return handed_on_ > 0;
}

bool Process::any_left() const { return !family_of(mark_).empty(); }

void Process::end_survivors(double longest) {
  const auto start = std::chrono::steady_clock::now();
  while (any_left()) {
    const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - start;
    if (waited.count() >= longest) return kill_all();
    hand_on_interrupts();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

void Process::kill_all() {
  signal(SIGKILL);
  // Also those that were just being started; not for ever those that a device holds.
  const auto latest = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  for (auto left = family_of(mark_); !left.empty() && std::chrono::steady_clock::now() < latest;
       left = family_of(mark_)) {
    for (const pid_t pid : left) kill(pid, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  wait(10.0);
}

InterruptGuard::InterruptGuard() {
  if (guards++ > 0) return;
  interrupts = 0;
  nobody_reads = false;
  struct sigaction action {};
  action.sa_handler = note_interrupt;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < asking_to_stop.size(); ++i) {
    sigaction(asking_to_stop[i], nullptr, &earlier_actions[i]);
    if (earlier_actions[i].sa_handler != SIG_IGN) sigaction(asking_to_stop[i], &action, nullptr);
  }
}

InterruptGuard::~InterruptGuard() {
  if (--guards > 0) return;
  for (std::size_t i = 0; i < asking_to_stop.size(); ++i)
    sigaction(asking_to_stop[i], &earlier_actions[i], nullptr);
  // What is left to say must not end us now.
  if (nobody_reads) std::signal(SIGPIPE, SIG_IGN);
}

int InterruptGuard::count() { return interrupts; }

}  // namespace flowrest::runs
