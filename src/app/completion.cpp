// barchan completion: what a shell needs to complete commands, options, scenes and keys. Scenes and keys are asked of
// the program when they are wanted, so that those of the scene on the line are offered.
#include <algorithm>
#include <string>

#include "app/command_words.hpp"
#include "app/habits.hpp"

namespace barchan {
namespace {

std::string joined(const std::vector<std::string>& words, const std::string& between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

std::string names_of(const std::vector<CommandTable>& tables) {
  std::string names;
  for (const CommandTable& table : tables) names += (names.empty() || table.name.empty() ? "" : " ") + table.name;
  return names;
}

/// 'text' of a shell.
std::string quoted(const std::string& text) { return "'" + with_each(text, "'", "'\\''") + "'"; }

// ---- bash

/// The calls that fill COMPREPLY with what may stand for a word.
std::string bash_of(const CommandWord& word) {
  std::string calls;
  const auto call = [&](const std::string& what) { calls += (calls.empty() ? "" : "; ") + what; };
  if (word.takes_a("SCENE")) call("_barchan_scenes");
  if (word.takes_a_key()) call("_barchan_keys");
  if (word.takes_a("DIR")) call("_barchan_files -d");
  if (word.takes_a("FILE")) call("_barchan_files -f");
  if (const auto choices = word.choices(); !choices.empty()) call("_barchan_words \"" + joined(choices, " ") + "\"");
  return calls.empty() ? ":" : calls;
}

constexpr const char* bash_functions = R"bash(
_barchan_words() { COMPREPLY+=($(compgen -W "$1" -- "$cur")); }

_barchan_files() { compopt -o filenames 2>/dev/null; COMPREPLY+=($(compgen "$1" -- "$cur")); }

_barchan_ask() { "${COMP_WORDS[0]/#\~/$HOME}" list "$@" --names 2>/dev/null; }

_barchan_scenes() {
  _barchan_words "$(_barchan_ask scenes)"
  compopt -o filenames 2>/dev/null
  COMPREPLY+=($(compgen -f -X '!*.toml' -- "$cur") $(compgen -d -S / -- "$cur"))
}

# Keys of the scene on the line, or of any scene, as far as the next dot.
_barchan_keys() {
  local key rest word after_value="" known=" " scene=""
  for word in "${COMP_WORDS[@]:2}"; do
    if [[ -z $after_value && $word != -* && -n $word ]]; then scene=$word; break; fi
    after_value=""
    case "$word" in
      @VALUED@) after_value=yes ;;
    esac
  done
  compopt -o nospace 2>/dev/null
  for key in $(_barchan_ask keys ${scene:+--of "$scene"} || _barchan_ask keys); do
    [[ $key == "$cur"* ]] || continue
    rest=${key#"$cur"}
    if [[ $rest == *.* ]]; then word=$cur${rest%%.*}.; else word=$key=; fi
    if [[ $known != *" $word "* ]]; then COMPREPLY+=("$word"); known+="$word "; fi
  done
}
)bash";

std::string bash_script(const std::vector<CommandTable>& tables) {
  std::vector<std::string> valued;
  std::string cases, options, places;
  for (const CommandTable& table : tables) {
    std::string names, by_place;
    for (const CommandWord& word : table.words) {
      names += (names.empty() || word.by_place() ? "" : " ") + joined(word.names, " ");
      if (word.by_place()) by_place += (by_place.empty() ? "" : "; ") + bash_of(word);
      if (word.by_place() || word.takes.empty()) continue;
      for (const std::string& name : word.names) {
        cases += "    \"" + table.name + " " + name + "\") " + bash_of(word) + "; return ;;\n";
        if (std::find(valued.begin(), valued.end(), name) == valued.end()) valued.push_back(name);
      }
    }
    options += "    \"" + table.name + "\") _barchan_words \"" + names + "\" ;;\n";
    if (!by_place.empty()) places += "    \"" + table.name + "\") " + by_place + " ;;\n";
  }
  return "# Completion of barchan for bash, made by `barchan completion bash`: put it into\n"
         "# ~/.local/share/bash-completion/completions/barchan\n" +
         with_each(bash_functions, "@VALUED@", joined(valued, " | ")) +
         "\n_barchan() {\n"
         "  local cur=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} command=\"\"\n"
         "  COMPREPLY=()\n"
         "  if ((COMP_CWORD > 1)); then command=${COMP_WORDS[1]}; fi\n"
         "  case \"$command $previous\" in\n" +
         cases +
         "  esac\n"
         "  if [[ $cur == -* ]]; then\n    case \"$command\" in\n" +
         with_each(options, "    \"", "      \"") +
         "    esac\n    return\n  fi\n"
         "  case \"$command\" in\n"
         "    \"\") _barchan_words \"" +
         names_of(tables) + "\" ;;\n" + places + "  esac\n}\ncomplete -F _barchan barchan\n";
}

// ---- zsh

/// ":what:action" of _arguments.
std::string zsh_of(const CommandWord& word) {
  if (word.takes.empty()) return "";
  std::string action = " ";
  if (word.takes_a("SCENE")) action = "_barchan_scenes";
  else if (word.takes_a_key()) action = "_barchan_keys";
  else if (word.takes_a("DIR")) action = "_files -/";
  else if (word.takes_a("FILE")) {
    const auto choices = word.choices();
    action = choices.empty() ? "_files" : "{compadd " + joined(choices, " ") + "; _files}";
  } else if (const auto choices = word.choices(); !choices.empty()) {
    action = "(" + joined(choices, " ") + ")";
  }
  return ":" + with_each(word.takes, ":", "\\:") + ":" + action;
}

std::string zsh_script(const std::vector<CommandTable>& tables) {
  const auto plain = [](const std::string& text) {
    return with_each(with_each(with_each(text, "[", "("), "]", ")"), ":", "\\:");
  };
  std::string commands, cases;
  for (const CommandTable& table : tables) {
    std::string arguments;
    for (const CommandWord& word : table.words) {
      if (word.by_place()) arguments += " \\\n        " + quoted(zsh_of(word));
      for (const std::string& name : word.names)
        arguments += " \\\n        " +
                     quoted((word.takes_a_key() ? "*" : "") + name + "[" + plain(word.meaning) + "]" + zsh_of(word));
    }
    if (table.name.empty()) continue;
    commands += "    " + quoted(table.name + ":" + plain(table.meaning)) + "\n";
    cases += "    " + table.name + ")\n      _arguments" + arguments + "\n      ;;\n";
  }
  return "#compdef barchan\n# Completion of barchan for zsh, made by `barchan completion zsh`: put it into a folder of "
         "$fpath as _barchan\n\n"
         "_barchan_scenes() {\n  local -a names\n"
         "  names=(${(f)\"$($barchan list scenes --names 2>/dev/null)\"})\n"
         "  compadd -a names\n  _files -g '*.toml'\n}\n\n"
         "_barchan_keys() {\n  local -a keys\n  local scene=${words[(r)^-*]}\n"
         "  keys=(${(f)\"$($barchan list keys --names --of \"${words[2]}\" 2>/dev/null || $barchan list keys --names "
         "2>/dev/null)\"})\n"
         "  compadd -S = -a keys\n}\n\n"
         "_barchan() {\n  local curcontext=\"$curcontext\" barchan=${words[1]} state line\n  local -a commands\n  "
         "commands=(\n" +
         commands +
         "  )\n  if ((CURRENT == 2)); then\n    _describe command commands\n    return\n  fi\n"
         "  shift words\n  ((CURRENT--))\n  case ${words[1]} in\n" +
         cases +
         "  esac\n}\n\nif [[ $funcstack[1] == _barchan ]]; then _barchan \"$@\"; else compdef _barchan barchan; fi\n";
}

// ---- fish

std::string fish_of(const CommandWord& word) {
  std::string text;
  const auto offer = [&](const std::string& what) { text += " -a " + quoted(what); };
  if (word.takes_a("SCENE")) offer("(barchan list scenes --names)");
  if (word.takes_a_key()) offer("(__barchan_keys)");
  if (word.takes_a("DIR")) offer("(__fish_complete_directories (commandline -ct))");
  if (const auto choices = word.choices(); !choices.empty()) offer(joined(choices, " "));
  const bool files = word.takes_a("FILE") || word.takes_a("SCENE");
  if (word.by_place()) return text + (files ? " -F" : "");
  return word.takes.empty() ? "" : (files ? " -r -F" : " -x") + text;
}

std::string fish_script(const std::vector<CommandTable>& tables) {
  std::string text =
      "# Completion of barchan for fish, made by `barchan completion fish`: put it into "
      "~/.config/fish/completions/barchan.fish\n\n"
      "function __barchan_keys\n"
      "    set -l words (commandline -opc)\n"
      "    set -l keys (barchan list keys --names --of \"$words[3]\" 2>/dev/null)\n"
      "    or set keys (barchan list keys --names 2>/dev/null)\n"
      "    printf '%s=\\n' $keys\n"
      "end\n\ncomplete -c barchan -f\n";
  for (const CommandTable& table : tables) {
    const std::string when = table.name.empty() ? "__fish_use_subcommand" : "__fish_seen_subcommand_from " + table.name;
    if (!table.name.empty())
      text += "complete -c barchan -n __fish_use_subcommand -a " + table.name + " -d " + quoted(table.meaning) + "\n";
    for (const CommandWord& word : table.words) {
      std::string names;
      for (const std::string& name : word.names)
        names += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      const std::string offers = fish_of(word);
      if (names.empty() && offers.empty()) continue;
      text += "complete -c barchan -n " + quoted(when) + names + offers + " -d " + quoted(word.meaning) + "\n";
    }
  }
  return text;
}

}  // namespace

std::string completion_script(const CLI::App& app, const std::string& shell) {
  const auto tables = command_tables(app);
  return shell == "bash" ? bash_script(tables) : shell == "zsh" ? zsh_script(tables) : fish_script(tables);
}

}  // namespace barchan
