#include "app/command_words.hpp"

#include <cctype>

namespace barchan {
namespace {

/// "N" of "N:INT in [1 - 4096]": what is allowed follows from a check, and its message says it.
std::string without_range(const std::string& takes) { return takes.substr(0, takes.find(':')); }

}  // namespace

CommandTable command_table(const CLI::App& app) {
  CommandTable table{app.get_name(), app.get_description(), {}};
  for (const CLI::Option* option : app.get_options()) {
    CommandWord word;
    for (const std::string& name : option->get_snames()) word.names.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) word.names.push_back("--" + name);
    if (option->get_items_expected_max() > 0) word.takes = without_range(option->get_type_name());
    word.meaning = option->get_description();
    word.required = option->get_required();
    word.option = option->get_name();
    table.words.push_back(word);
  }
  return table;
}

std::vector<std::string> CommandWord::choices() const {
  std::vector<std::string> words(1);
  for (const char c : takes) {
    if (c == '|') words.emplace_back();
    else words.back() += c;
  }
  std::erase_if(words,
                [](const std::string& w) { return w.empty() || !std::islower(static_cast<unsigned char>(w[0])); });
  return words;
}

std::vector<CommandTable> command_tables(const CLI::App& app) {
  std::vector<CommandTable> tables{command_table(app)};
  tables.front().name = "";
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    tables.push_back(command_table(*command));
  return tables;
}

std::string with_each(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

}  // namespace barchan
