#include "app/habits.hpp"

#include <iostream>
#include <memory>

#include "checks/reader.hpp"
#include "scene/schema.hpp"

namespace barchan {
namespace {

/// What the options of the commands below are read into.
struct Chosen {
  std::string what, scene, name, from = "minimal", shell;
  bool names = false, json = false, markdown = false;
};

}  // namespace

void add_habits(CLI::App& app, int& status) {
  const auto chosen = std::make_shared<Chosen>();  // lives as long as the commands

  auto* c_list = app.add_subcommand("list", "show the scenes and the ParaView states that come along");
  c_list->add_option("what", chosen->what, "what to show (default: scenes and states)")
      ->type_name("scenes|states|keys")
      ->check(CLI::IsMember({"scenes", "states", "keys"}));
  c_list->add_option("--of", chosen->scene, "with keys: those of this scene, with the names of its phases and pairs")
      ->type_name("SCENE");
  c_list->add_flag("--names", chosen->names, "the names alone, one a line");
  c_list->add_flag("--json", chosen->json, "as JSON");
  c_list->callback([chosen, &status] { status = list(chosen->what, chosen->scene, chosen->names, chosen->json); });

  auto* c_new = app.add_subcommand("new", "begin a scene of your own: a commented copy of one that comes along");
  c_new->add_option("name", chosen->name, "the new scene: NAME.toml, a folder may stand before it")
      ->type_name("NAME")
      ->required();
  c_new->add_option("--from", chosen->from, "the scene to copy (default: minimal, with a comment at each key)")
      ->type_name("SCENE");
  c_new->callback([chosen, &status] { status = make_new(chosen->name, chosen->from); });

  auto* c_schema = app.add_subcommand("schema", "print the JSON schema of a scene file");
  c_schema->add_flag("--markdown", chosen->markdown, "all keys as tables to read, in place of the schema");
  c_schema->callback([chosen, &status] {
    std::cout << (chosen->markdown ? scene_tables() : scene_schema()) << '\n';
    status = 0;
  });

  auto* c_completion =
      app.add_subcommand("completion", "print a script with which a shell completes commands and keys");
  c_completion->add_option("shell", chosen->shell, "the shell")
      ->type_name("bash|zsh|fish")
      ->check(CLI::IsMember({"bash", "zsh", "fish"}))
      ->required();
  c_completion->callback([chosen, &app, &status] {
    std::cout << completion_script(app, chosen->shell);
    status = 0;
  });

  app.add_subcommand("man", "print the manual page: barchan man | man -l -")->callback([&app, &status] {
    std::cout << manual_page(app);
    status = 0;
  });
}

}  // namespace barchan
