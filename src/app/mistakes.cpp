#include "app/mistakes.hpp"

#include <algorithm>
#include <map>

#include "app/command_words.hpp"
#include "app/shipped.hpp"
#include "base/errors.hpp"
#include "scene/keys.hpp"
#include "scene/nearest.hpp"

namespace barchan {
namespace {

/// Words of other programs, and what they are called here.
const std::map<std::string, std::string>& other_commands() {
  static const std::map<std::string, std::string> words{{"start", "run SCENE"},
                                                        {"simulate", "run SCENE"},
                                                        {"solve", "run SCENE"},
                                                        {"exec", "run SCENE"},
                                                        {"check", "plan SCENE"},
                                                        {"validate", "plan SCENE"},
                                                        {"dry", "plan SCENE"},
                                                        {"info", "plan SCENE"},
                                                        {"init", "new NAME"},
                                                        {"create", "new NAME"},
                                                        {"copy", "new NAME"},
                                                        {"ls", "list"},
                                                        {"scenes", "list scenes"},
                                                        {"states", "list states"},
                                                        {"keys", "list keys"},
                                                        {"examples", "list scenes"},
                                                        {"diff", "compare A B"},
                                                        {"help", "--help"},
                                                        {"version", "--version"},
                                                        {"manual", "man"},
                                                        {"restart", "run SCENE --restart latest"},
                                                        {"resume", "run SCENE --restart latest"},
                                                        {"continue", "run SCENE --restart latest"}};
  return words;
}

const std::map<std::string, std::string>& other_options() {
  static const std::map<std::string, std::string> words{{"-o", "--out DIR"},
                                                        {"--output", "--out DIR"},
                                                        {"-d", "--out DIR"},
                                                        {"-j", "--threads N"},
                                                        {"-n", "--threads N"},
                                                        {"-t", "--threads N"},
                                                        {"-np", "--threads N"},
                                                        {"--jobs", "--threads N"},
                                                        {"--cores", "--threads N"},
                                                        {"--resume", "--restart latest"},
                                                        {"--continue", "--restart latest"},
                                                        {"-r", "--restart latest"},
                                                        {"-q", "--quiet"},
                                                        {"--silent", "--quiet"},
                                                        {"-s", "--set KEY=VALUE"},
                                                        {"-D", "--set KEY=VALUE"},
                                                        {"-p", "--set KEY=VALUE"},
                                                        {"--end", "--set time.end=SECONDS"},
                                                        {"--steps", "--set time.end=SECONDS"},
                                                        {"--tol", "--tolerance NUMBER"},
                                                        {"-v", "`barchan --version`"},
                                                        {"-V", "`barchan --version`"}};
  return words;
}

bool ends_as_option(const std::string& name, const CLI::App& command) {
  const auto options = command.get_options();
  return std::any_of(options.begin(), options.end(), [&](const CLI::Option* o) { return o->check_name(name); });
}

/// The key of a scene that an option names, as --time.end=1 or --spacing 1e-3; empty: none.
std::string key_of(const std::string& option) {
  const std::string dotted = option.substr(std::min(option.find_first_not_of('-'), option.size()));
  const std::size_t dot = dotted.rfind('.');
  const std::string section = dot == std::string::npos ? "" : dotted.substr(0, dot);
  return find_key(section, dotted.substr(dot == std::string::npos ? 0 : dot + 1)) ? dotted : "";
}

std::string unknown_option(const CLI::App& command, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  const std::string what = "unknown option " + shortened(name);
  if (const auto other = other_options().find(name); other != other_options().end()) {
    const std::string meant = other->second.substr(0, other->second.find(' '));
    if (meant.starts_with('`') || ends_as_option(meant, command)) return what + "; did you mean " + other->second + "?";
  }
  if (const std::string key = key_of(name); !key.empty())
    return what + "; did you mean --set " + key + (word == name ? "=VALUE" : word.substr(word.find('='))) + "?";
  std::vector<std::string> known;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& each : option->get_lnames()) known.push_back("--" + each);
  const std::string meant = nearest(name, known);
  return what + (meant.empty() ? "; expected " + one_of(known) : "; did you mean " + meant + "?");
}

/// "barchan run SCENE", with all words by their place.
std::string usage(const CLI::App& command) {
  std::string text = "barchan " + command.get_name();
  for (const CommandWord& word : command_table(command).words)
    if (word.by_place()) text += " " + word.takes;
    else if (word.required) text += " " + word.names.front() + " " + word.takes;
  return text;
}

std::string unexpected(const CLI::App& command, const std::vector<std::string>& words,
                       const std::vector<std::string>& extras) {
  for (const std::string& word : words)  // in the order in which they were typed
    if (word.starts_with('-') && word.size() > 1 && std::find(extras.begin(), extras.end(), word) != extras.end())
      return unknown_option(command, word);
  for (const std::string& word : words) {
    if (std::find(extras.begin(), extras.end(), word) == extras.end()) continue;
    if (word.starts_with('=')) return "\"=\" stands alone; expected KEY=VALUE without blanks, as in time.end=0.01";
    if (word.find('=') != std::string::npos)
      return "\"" + shortened(word) + "\" stands alone; did you mean --set '" + shortened(word) + "'?";
    return "\"" + shortened(word) + "\" is one word too many; expected `" + usage(command) +
           "`, values with blanks in quotes";
  }
  return "a word too many; expected `" + usage(command) + "`";
}

/// The first option or word that must be there and is not.
std::string missing(const CLI::App& command) {
  const auto words = command_table(command).words;
  std::size_t k = 0;
  for (const CLI::Option* option : command.get_options()) {
    const CommandWord& word = words[k++];
    if (!option->get_required() || option->count() > 0) continue;
    return (word.by_place() ? word.takes : word.names.back() + " " + word.takes) + " is missing; expected `" +
           usage(command) + "`" + (word.takes == "SCENE" ? ", as in `barchan " + command.get_name() + " dune`" : "");
  }
  return "";
}

/// An option that has no value behind it.
std::string without_value(const CLI::App& command, const std::string& said) {
  for (const CommandWord& word : command_table(command).words)
    for (const std::string& name : word.names)
      if (said.starts_with(name + ":"))
        return name + " has no value; expected " + name + " " + word.takes +
               (word.takes == "KEY=VALUE" ? ", as in --set time.end=0.01" : "");
  return said;
}

/// "what: dune not in {scenes,states,keys}" and other values that are not allowed.
std::string not_allowed(const CLI::App& command, const std::string& said) {
  for (const CommandWord& word : command_table(command).words) {
    const std::string name = word.by_place() ? word.option : word.names.back();
    if (!said.starts_with(name + ": ")) continue;
    const auto choices = word.choices();
    std::string found = said.substr(name.size() + 2);
    if (choices.empty() || word.takes_a("FILE")) return with_each(found.insert(0, name + ": "), "Value ", "");
    found = found.substr(0, found.find(" not in "));
    return "\"" + found + "\" is not known; expected " + one_of(choices) + did_you_mean(nearest(found, choices));
  }
  return said;
}

}  // namespace

std::string not_a_command(const CLI::App& app, const std::string& word) {
  if (word.starts_with('-')) return "";
  std::vector<std::string> names;
  std::string list = "commands:\n";
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == word) return "";
    names.push_back(command->get_name());
    list += "  " + names.back() + std::string(12 - std::min<std::size_t>(names.back().size(), 11), ' ') +
            command->get_description() + '\n';
  }
  if (word.empty()) return "no command\n" + list;
  bool scene = word.ends_with(".toml");
  std::string meant = scene ? "barchan run " + word : nearest(word, names);
  if (const auto other = other_commands().find(word); other != other_commands().end())
    meant = "barchan " + other->second;
  if (meant.empty())
    for (const ShippedScene& each : shipped_scenes())
      if (each.name == word) scene = true, meant = "barchan run " + word;
  return "\"" + word + "\" is " + (scene ? "a scene, not a command" : "not a command") + did_you_mean(meant) + '\n' +
         list;
}

std::string wrong_command(const CLI::App& app, const CLI::ParseError& error, const std::vector<std::string>& words) {
  const bool chosen = !app.get_subcommands().empty();
  const CLI::App& command = chosen ? *app.get_subcommands().front() : app;
  const std::string said = error.what();
  std::string what;
  if (dynamic_cast<const CLI::ExtrasError*>(&error)) what = unexpected(command, words, app.remaining(true));
  else if (!chosen) what = unknown_option(command, words.size() > 1 ? words[1] : "");
  else if (dynamic_cast<const CLI::RequiredError*>(&error)) what = missing(command);
  else if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) what = without_value(command, said);
  else if (dynamic_cast<const CLI::ValidationError*>(&error)) what = not_allowed(command, said);
  if (what.empty()) what = said;
  return what + "\n`barchan " + (chosen ? command.get_name() + " " : "") + "--help` says more.\n";
}

}  // namespace barchan
