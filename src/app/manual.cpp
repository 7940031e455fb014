// barchan man: the manual page, from the tables of the program.
#include <string>

#include "app/command_words.hpp"
#include "app/habits.hpp"
#include "base/version.hpp"

namespace barchan {
namespace {

/// Text for roff: a hyphen of an option stays one, and no line begins with a request.
std::string roff(const std::string& text) {
  std::string safe = with_each(with_each(text, "\\", "\\e"), "-", "\\-");
  safe = with_each(safe, "\n", "\n.br\n");
  return !safe.empty() && (safe.front() == '.' || safe.front() == '\'') ? "\\&" + safe : safe;
}

std::string italic(const std::string& text) { return text.empty() ? "" : " \\fI" + roff(text) + "\\fR"; }

std::string label(const CommandWord& word) {
  if (word.by_place()) return "\\fI" + roff(word.takes) + "\\fR";
  std::string text;
  for (const std::string& name : word.names) text += (text.empty() ? "\\fB" : ", \\fB") + roff(name) + "\\fR";
  return text + italic(word.takes);
}

std::string options(const CommandTable& table) {
  std::string text;
  for (const CommandWord& word : table.words) text += ".TP\n" + label(word) + "\n" + roff(word.meaning) + ".\n";
  return text;
}

/// "barchan run SCENE [--out DIR] ..."
std::string synopsis(const CommandTable& table) {
  std::string text = "\\fBbarchan " + roff(table.name) + "\\fR";
  for (const CommandWord& word : table.words)
    if (word.by_place()) text += word.required ? italic(word.takes) : " [" + italic(word.takes).substr(1) + "]";
  for (const CommandWord& word : table.words)
    if (!word.by_place() && word.names.back() != "--help")
      text +=
          " [\\fB" + roff(word.names.back()) + "\\fR" + italic(word.takes) + "]" + (word.takes_a_key() ? " ..." : "");
  return text;
}

}  // namespace

std::string manual_page(const CLI::App& app) {
  const auto tables = command_tables(app);
  std::string text = ".TH BARCHAN 1 \"\" \"barchan " + roff(version()) + "\" \"User Commands\"\n" +
                     ".SH NAME\nbarchan \\- " + roff(with_each(app.get_description(), "Barchan: ", "")) + "\n" +
                     ".SH SYNOPSIS\n";
  bool first = true;
  for (const CommandTable& table : tables) {
    if (table.name.empty()) continue;
    text += (first ? "" : ".br\n") + synopsis(table) + "\n";
    first = false;
  }
  text +=
      ".SH DESCRIPTION\nBarchan reads a scene file (TOML, SI units), integrates it with smoothed particle "
      "hydrodynamics "
      "and writes a series\nfor ParaView: NAME.pvd with its frames, history.csv, run.json and checkpoints.\n"
      ".PP\nA \\fISCENE\\fR is a file that ends in .toml, or the name of a scene that comes along (\\fBbarchan "
      "list\\fR).\nA \\fIKEY=VALUE\\fR is a dotted key of the scene file with a value, as in time.end=0.01 "
      "(\\fBbarchan list "
      "keys\\fR).\n";
  for (const CommandTable& table : tables)
    text += table.name.empty() ? ".SH OPTIONS\n" + options(table) + ".SH COMMANDS\n"
                               : ".SS " + roff(table.name) + "\n" + roff(table.meaning) + ".\n" + options(table);
  const auto data = [&](const char* name, const char* what) {
    return ".TP\n\\fI" + roff(name) + "\\fR\n" + what + "\n";
  };
  text +=
      ".SH EXIT STATUS\n" + roff(app.get_footer()) + "\n.SH ENVIRONMENT\n" +
      data("NO_COLOR", "When it is set, nothing is coloured. Colours stand on a terminal only.") +
      data("OMP_NUM_THREADS", "The largest number of threads of a run, or of a rank, without \\-\\-threads.") +
      ".SH FILES\n" + data("PREFIX/share/barchan/scenes", "Scenes, and their schema for editors, scene.schema.json.") +
      data("PREFIX/share/barchan/pvstate", "States of ParaView, and render, which makes pictures and films.") +
      ".SH EXAMPLES\n.nf\nbarchan new mine \\-\\-from dune\nbarchan plan mine.toml\nbarchan run mine.toml \\-\\-set "
      "time.end=0.01\n.fi\n";
  return text;
}

}  // namespace barchan
