#include "compare/report/browser.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cctype>
#include <chrono>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <thread>

#include "compare/report/picture_size.h"
#include "runs/environment.h"
#include "runs/process.h"

namespace flowrest::report {

namespace {

constexpr int answer_limit = 60000;  // ms

std::string from_base64(const std::string& text) {
  std::string bytes;
  std::uint32_t word = 0;
  int bits = 0;
  for (const char c : text) {
    const std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const auto at = letters.find(c);
    if (at == std::string_view::npos) continue;
    word = word << 6 | static_cast<std::uint32_t>(at);
    if ((bits += 6) >= 8) bytes += static_cast<char>(word >> (bits -= 8) & 0xffu);
  }
  return bytes;
}

/// In the child: the pipe's ends become descriptors 3 and 4, as --remote-debugging-pipe expects them.
[[noreturn]] void become_browser(const char* program, char* const* arguments, char* const* environment,
                                 int in, int out) {
  setpgid(0, 0);
  const int reads = fcntl(in, F_DUPFD, 10), writes = fcntl(out, F_DUPFD, 10);
  dup2(reads, 3);
  dup2(writes, 4);
  const int nowhere = ::open("/dev/null", O_RDWR);
  dup2(nowhere, 1);
  dup2(nowhere, 2);
  for (int other = 5; other < 64; ++other) close(other);
  execve(program, arguments, environment);
  _exit(127);
}

/// The address of a file: what means something in an address is written as its number.
std::string address_of(const std::filesystem::path& file) {
  std::string address = "file://";
  for (const char c : std::filesystem::absolute(file).string()) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                       std::string_view("/._-~").find(c) != std::string_view::npos;
    constexpr const char* digits = "0123456789ABCDEF";
    if (plain) {
      address += c;
    } else {
      address += '%';
      address += digits[static_cast<unsigned char>(c) >> 4];
      address += digits[static_cast<unsigned char>(c) & 15];
    }
  }
  return address;
}

}  // namespace

std::string browser_program() {
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"})
    if (runs::find_program(name)) return name;
  return "";
}

Browser::Browser(const std::filesystem::path& folder) {
  std::array<int, 2> commands{}, answers{};
  if (pipe(commands.data()) != 0 || pipe(answers.data()) != 0)
    throw std::runtime_error("no pipe to the browser");
  const auto program = runs::find_program(browser_program());
  if (!program) throw std::runtime_error("there is no browser");
  std::vector<std::string> texts = {program->string(),
                                    "--headless",
                                    "--no-sandbox",
                                    "--disable-gpu",
                                    "--remote-debugging-pipe",
                                    "--hide-scrollbars",
                                    "--disable-background-networking",
                                    "--disable-component-update",
                                    "--disable-sync",
                                    "--no-first-run",
                                    "--user-data-dir=" + (folder / "profile").string(),
                                    "about:blank"};
  std::vector<std::string> told = runs::texts_of(runs::Environment::of_helper().entries());
  const auto arguments = runs::pointers_to(texts), environment = runs::pointers_to(told);
  process_ = fork();
  if (process_ == 0)
    become_browser(program->c_str(), arguments.data(), environment.data(), commands[0], answers[1]);
  close(commands[0]);
  close(answers[1]);
  to_ = commands[1];
  from_ = answers[0];
  signal(SIGPIPE, SIG_IGN);
  const Json target = call("Target.createTarget", {{"url", "about:blank"}});
  session_ =
      call("Target.attachToTarget", {{"targetId", target["targetId"]}, {"flatten", true}})["sessionId"];
  for (const char* domain : {"Page.enable", "Runtime.enable", "Log.enable", "Network.enable"}) call(domain);
  call("Emulation.setFocusEmulationEnabled", {{"enabled", true}});
}

Browser::~Browser() {
  close(to_);
  close(from_);
  kill(-process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

nlohmann::json Browser::receive() {
  for (;;) {
    if (const auto end = buffer_.find('\0'); end != std::string::npos) {
      Json message = Json::parse(buffer_.substr(0, end));
      buffer_.erase(0, end + 1);
      return message;
    }
    pollfd waiting{from_, POLLIN, 0};
    if (poll(&waiting, 1, answer_limit) <= 0) throw std::runtime_error("the browser does not answer");
    std::array<char, 65536> part{};
    const ssize_t count = read(from_, part.data(), part.size());
    if (count <= 0) throw std::runtime_error("the browser has ended");
    buffer_.append(part.data(), static_cast<std::size_t>(count));
  }
}

void Browser::note(const Json& event) {
  const std::string method = event.value("method", "");
  if (method == "Page.loadEventFired") loaded_ = true;
  const bool complaint = method == "Runtime.exceptionThrown" || method == "Runtime.consoleAPICalled" ||
                         method == "Log.entryAdded";
  if (complaint) complaints_.push_back(event["params"].dump().substr(0, 600));
  if (method == "Network.requestWillBeSent") {
    const std::string url = event["params"]["request"].value("url", "");
    if (url.starts_with("http")) complaints_.push_back("asks for " + url);
  }
}

nlohmann::json Browser::call(const std::string& method, const Json& parameters) {
  Json message = {{"id", ++calls_}, {"method", method}, {"params", parameters}};
  if (!session_.empty()) message["sessionId"] = session_;
  const std::string text = message.dump() + '\0';
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t count = write(to_, text.data() + sent, text.size() - sent);
    if (count <= 0) throw std::runtime_error("the browser has gone");
    sent += static_cast<std::size_t>(count);
  }
  for (;;) {
    Json answer = receive();
    if (answer.value("id", 0) != calls_) {
      note(answer);
      continue;
    }
    if (answer.contains("error")) throw std::runtime_error(method + ": " + answer["error"].dump());
    return answer["result"];
  }
}

void Browser::window(int width, int height, bool telephone) {
  seen_ = {width * (telephone ? 2 : 1), height * (telephone ? 2 : 1)};
  call("Emulation.setDeviceMetricsOverride", {{"width", width},
                                              {"height", height},
                                              {"deviceScaleFactor", telephone ? 2 : 1},
                                              {"mobile", telephone}});
}

void Browser::prefer(const std::string& scheme) {
  call("Emulation.setEmulatedMedia",
       {{"features", Json::array({{{"name", "prefers-color-scheme"}, {"value", scheme}}})}});
}

void Browser::open(const std::filesystem::path& file, const std::string& hash) {
  call("Page.navigate", {{"url", "about:blank"}});
  while (!loaded_) note(receive());
  loaded_ = false;
  call("Page.navigate", {{"url", address_of(file) + hash}});
  while (!loaded_) note(receive());
  loaded_ = false;
}

nlohmann::json Browser::evaluate(const std::string& script) {
  const Json result =
      call("Runtime.evaluate", {{"expression", script}, {"awaitPromise", true}, {"returnByValue", true}});
  if (result.contains("exceptionDetails")) throw std::runtime_error(result["exceptionDetails"].dump());
  return result["result"].contains("value") ? result["result"]["value"] : Json();
}

bool Browser::wait_for(const std::string& script, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end) {
    if (evaluate(script) == true) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

void Browser::press(const std::string& key) {
  Json event = {{"type", "keyDown"}, {"key", key}, {"code", key}};
  const std::pair<const char*, int> codes[] = {
      {"Tab", 9},        {"Enter", 13},   {"Escape", 27},     {"End", 35},       {"Home", 36},
      {"ArrowLeft", 37}, {"ArrowUp", 38}, {"ArrowRight", 39}, {"ArrowDown", 40}, {" ", 32}};
  for (const auto& [name, code] : codes)
    if (key == name) event["windowsVirtualKeyCode"] = code;
  if (key == "Enter") event["text"] = "\r";
  call("Input.dispatchKeyEvent", event);
  event["type"] = "keyUp";
  event.erase("text");
  call("Input.dispatchKeyEvent", event);
}

void Browser::point(double x, double y) {
  call("Input.dispatchMouseEvent", {{"type", "mouseMoved"}, {"x", x}, {"y", y}});
}

void Browser::click(double x, double y) {
  point(x, y);
  for (const char* type : {"mousePressed", "mouseReleased"})
    call("Input.dispatchMouseEvent",
         {{"type", type}, {"x", x}, {"y", y}, {"button", "left"}, {"clickCount", 1}});
}

std::pair<double, double> Browser::place_of(const std::string& selector) {
  const Json place =
      evaluate("(() => { const node = document.querySelector(" + Json(selector).dump() +
               "); node.scrollIntoView({block: 'center'}); const box = node.getBoundingClientRect();"
               "return [box.x + box.width / 2, box.y + box.height / 2]; })()");
  return {place[0].get<double>(), place[1].get<double>()};
}

void Browser::screenshot(const std::filesystem::path& file) {
  std::ofstream(file, std::ios::binary)
      << from_base64(call("Page.captureScreenshot", {{"format", "png"}})["data"]);
  if (const auto size = png_size(file); !size || (seen_ && *size != *seen_))
    throw std::runtime_error(file.string() + ": the picture is not whole or not of the window's size");
}

std::string Browser::pdf() {
  return from_base64(
      call("Page.printToPDF", {{"printBackground", true}, {"preferCSSPageSize", true}})["data"]);
}

}  // namespace flowrest::report
