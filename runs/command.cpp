#include "runs/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <system_error>

#include "runs/material_state.h"
#include "runs/process.h"

namespace flowrest::runs {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr const char* name_of_program = "flowrest";

/// The first word by which this process was called.
std::string called_as() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::string word;
  std::getline(file, word, '\0');
  return word;
}

/// This program as whoever reads a message can call it.
std::string program() {
  const fs::path self = "/proc/self/exe";
  std::error_code error;
  const fs::path file = fs::read_symlink(self, error);
  if (file.filename() != name_of_program) return name_of_program;
  const auto found = find_program(name_of_program);
  if (found && fs::equivalent(*found, self, error)) return name_of_program;
  const std::string called = called_as();
  // Whoever starts a program may call it what he likes.
  return fs::equivalent(called, self, error) ? called : file.string();
}

bool is_plain(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
         std::string_view("_-+=.,:/@%").find(c) != std::string::npos;
}

std::string text_at(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

std::vector<std::string> texts_at(const Json& json, const char* key) {
  std::vector<std::string> texts;
  if (const auto found = json.find(key); found != json.end() && found->is_array())
    for (const Json& item : *found)
      if (item.is_string()) texts.push_back(item.get<std::string>());
  return texts;
}

/// A scene named so long ago that its run says its name alone.
bool is_known(const std::string& scene) {
  std::error_code error;
  return !scene.empty() && fs::exists(scenes::scenes_folder() / (scene + ".toml"), error);
}

/// The first of out/SCENE/RUN, out/SCENE/RUN-2, ... at which nothing lies; none where that is the one that a
/// command takes by itself.
std::optional<fs::path> free_folder(const std::string& scene, const std::string& run) {
  const fs::path usual = fs::path("out") / scene / run;
  fs::path folder = usual;
  std::error_code error;
  for (int i = 2; fs::exists(folder, error); ++i) folder = fmt::format("{}-{}", usual.string(), i);
  return folder == usual ? std::nullopt : std::optional(folder);
}

}  // namespace

std::string shell_word(const std::string& text) {
  if (!text.empty() && std::all_of(text.begin(), text.end(), is_plain)) return text;
  std::string word = "'";
  for (const char c : text)
    if (c == '\'')
      word += "'\\''";
    else
      word += c;
  word += '\'';
  return word;
}

std::string path_argument(const fs::path& path) {
  return path.string().starts_with('-') ? fmt::format("./{}", path.string()) : path.string();
}

std::string command_line(const std::vector<std::string>& arguments) {
  std::string line = shell_word(program());
  for (const std::string& argument : arguments) line += fmt::format(" {}", shell_word(argument));
  return line;
}

Json request_json(const scenes::Request& request) {
  Json json = {{"scene", request.scene}, {"file", request.file.string()}, {"set", request.overrides.set}};
  if (request.overrides.model) json["model"] = scenes::to_string(*request.overrides.model);
  return json;
}

std::optional<scenes::Request> request_of(const Json& info) {
  scenes::Request request;
  if (const auto said = info.find("request"); said != info.end() && said->is_object()) {
    request = {text_at(*said, "scene"), text_at(*said, "file"), {texts_at(*said, "set"), std::nullopt}};
    const std::string model = text_at(*said, "model");
    if (!model.empty()) request.overrides.model = scenes::model_from_name(model);
  } else if (const std::string name = text_at(info, "scene_name"); is_known(name)) {
    request.scene = name;
  }
  return request.scene.empty() ? std::nullopt : std::optional(request);
}

std::string key_set_by(const std::string& setting) {
  std::string key = setting.substr(0, setting.find('='));
  std::erase_if(key, [](char c) { return c == ' ' || c == '\t'; });
  return key;
}

scenes::Request without_setting(scenes::Request request, const std::string& key) {
  std::erase_if(request.overrides.set,
                [&key](const std::string& setting) { return key_set_by(setting) == key; });
  return request;
}

std::vector<std::string> scene_arguments(const scenes::Request& request, const std::string& model) {
  std::string scene = request.scene;
  std::error_code error;
  if (scenes::is_path(scene)) {
    const bool leads_there = fs::equivalent(scene, request.file, error);
    scene = path_argument(leads_there || request.file.empty() ? fs::path(scene) : request.file);
  }
  std::vector<std::string> arguments = {scene};
  const auto own = request.overrides.model;
  const std::string named = !model.empty() ? model : own ? scenes::to_string(*own) : "";
  if (!named.empty()) arguments.insert(arguments.end(), {"--model", named});
  // A model that is named takes the place of one that is set.
  const auto kept = named.empty() ? request : without_setting(request, "material.model");
  for (const std::string& setting : kept.overrides.set) arguments.insert(arguments.end(), {"--set", setting});
  return arguments;
}

std::string command_to_resume(const std::string& solver, const fs::path& directory) {
  return command_line({solver, "--resume", path_argument(directory)});
}

std::optional<std::string> command_to_make(const Json& info, const std::string& solver,
                                           const std::string& model) {
  const auto request = request_of(info);
  if (!request) return std::nullopt;
  std::vector<std::string> arguments = scene_arguments(*request, model);
  arguments.insert(arguments.begin(), solver);
  if (const std::string from = started_from(info); !from.empty())
    arguments.insert(arguments.end(), {"--from", from});
  if (const auto folder = free_folder(text_at(info, "scene_name"), solver + "-" + model))
    arguments.insert(arguments.end(), {"-o", path_argument(*folder)});
  return command_line(arguments);
}

}  // namespace flowrest::runs
