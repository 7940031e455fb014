// Answers to a wrong command line: what is wrong, and what to type instead.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace barchan {

/// For a first word that is no command: what was probably meant, and the commands. Empty: it is one, or an option.
std::string not_a_command(const CLI::App& app, const std::string& word);

/// What is said of a command line that CLI11 could not read: one line, and what to type. `words` begin with the
/// program.
std::string wrong_command(const CLI::App& app, const CLI::ParseError& error, const std::vector<std::string>& words);

}  // namespace barchan
