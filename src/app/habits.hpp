// The subcommands that help a person along: list, new, completion, man, schema.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace barchan {

/// Adds them to the program. `status` gets what the chosen one returns.
void add_habits(CLI::App& app, int& status);

/// Names report and sweep, which the Python package does, and their options, for the lists of commands, the manual page
/// and the completion of shells.
void add_python_commands(CLI::App& app);

/// What `barchan list` shows. `what`: scenes, states, keys, or "" for scenes and states. `scene`: of keys, whose
/// phases, pairs and entries they name; "" for none. `names`: the names alone, one a line.
int list(const std::string& what, const std::string& scene, bool names, bool json);

/// Writes NAME.toml, a copy of the scene `from`, and the files that it reads, beside it. Throws SceneError when one of
/// them is there already, OutputError when it cannot be written.
int make_new(const std::string& name, const std::string& from);

/// A script with which the shell (bash, zsh or fish) completes the commands and options of `app`.
std::string completion_script(const CLI::App& app, const std::string& shell);

/// The manual page barchan(1) of all commands and options of `app`, in the macros of man(7).
std::string manual_page(const CLI::App& app);

}  // namespace barchan
