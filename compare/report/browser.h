#pragma once

#include <sys/types.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compare/report/picture_size.h"

/// A headless Chromium that a test drives through the DevTools protocol, over a pipe: no port, no network.
namespace flowrest::report {

/// The program that opens pages; empty where there is none.
std::string browser_program();

class Browser {
 public:
  using Json = nlohmann::json;

  /// Starts Chromium with a profile of its own in `folder`. @throws std::runtime_error where it does not
  /// start.
  explicit Browser(const std::filesystem::path& folder);
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  /// The window: CSS pixels, and whether it is a telephone's.
  void window(int width, int height, bool telephone = false);
  /// The reader's taste: "light" or "dark".
  void prefer(const std::string& scheme);
  /// Opens a file and waits until it has loaded.
  void open(const std::filesystem::path& file, const std::string& hash = "");
  /// The value of a script; a promise is waited for. @throws std::runtime_error with the page's error.
  Json evaluate(const std::string& script);
  /// Repeats a script until its value is true; false after `seconds`.
  bool wait_for(const std::string& script, double seconds = 10.0);
  /// Presses and releases a key, as a keyboard does: "ArrowRight", "Tab", "Enter".
  void press(const std::string& key);
  /// Moves the pointer to CSS pixels of the window, and clicks there.
  void point(double x, double y);
  void click(double x, double y);
  /// The centre of the element, scrolled into view.
  std::pair<double, double> place_of(const std::string& selector);
  /// Writes what is seen as PNG; the whole page or the window. @throws std::runtime_error where that is not
  /// what comes.
  void screenshot(const std::filesystem::path& file);
  /// The page printed to PDF.
  std::string pdf();
  /// What the page has said on its console, its errors and its attempts to reach a network.
  const std::vector<std::string>& complaints() const { return complaints_; }

  Json call(const std::string& method, const Json& parameters = Json::object());

 private:
  Json receive();
  void note(const Json& event);
  pid_t process_ = -1;
  int to_ = -1, from_ = -1;
  int calls_ = 0;
  std::string session_, buffer_;
  bool loaded_ = false;
  std::optional<PictureSize> seen_;  ///< pixels of the window
  std::vector<std::string> complaints_;
};

}  // namespace flowrest::report
