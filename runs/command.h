#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scenes/scene.h"

/// Commands that a message or a report advises: each runs as it is printed.
namespace flowrest::runs {

/// A text as one word of a POSIX shell: as it is where the shell reads nothing in it, else in single quotes.
std::string shell_word(const std::string&);

/// A path as an argument that no command takes for an option.
std::string path_argument(const std::filesystem::path&);

/// A call of this program as a shell takes it: "flowrest mpm 'my scene.toml' --set mpm.cell=0.01". It begins
/// with "flowrest" where that finds this program on the PATH, else as it was called or where it lies.
std::string command_line(const std::vector<std::string>& arguments);

/// A request as run.json has it, under "request".
nlohmann::ordered_json request_json(const scenes::Request&);

/// How the scene of a run was asked for, by its run.json; nothing where that does not say.
std::optional<scenes::Request> request_of(const nlohmann::ordered_json& info);

/// The key that a setting such as "time.end=120" sets.
std::string key_set_by(const std::string& setting);

/// A request without what it sets a key to.
scenes::Request without_setting(scenes::Request, const std::string& key);

/// The arguments that ask for a scene again, with a model or, where that is empty, with its own: the scene as
/// it was named, --model, every --set. A path that leads elsewhere from here is given in full.
std::vector<std::string> scene_arguments(const scenes::Request&, const std::string& model = "");

/// The command that goes on with a run of a solver ("mpm" or "foam"): "flowrest mpm --resume 'my run'".
std::string command_to_resume(const std::string& solver, const std::filesystem::path& directory);

/// The command that makes a run of the scene of another run, or that run anew: "flowrest foam roussel-slump
/// --model bi-viscous". It writes where nothing lies yet. Nothing where run.json does not say which scene it
/// was.
std::optional<std::string> command_to_make(const nlohmann::ordered_json& info, const std::string& solver,
                                           const std::string& model);

}  // namespace flowrest::runs
