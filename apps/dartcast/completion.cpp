// The verbs help and completion, which know all verbs and their options.
//
// The type of an option's value, as help shows it, says how the value is completed. Words with bars between them are
// the words that are allowed; VERB is one of the verbs. All else is left to the shell, which completes files.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "commands.hpp"
#include "limits.hpp"

namespace dartcast::app {

namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& n : option.get_snames()) names.push_back("-" + n);
  for (const std::string& n : option.get_lnames()) names.push_back("--" + n);
  return names;
}

std::string joined_names(const CLI::App& app) {
  std::vector<std::string> all;
  for (const CLI::Option* option : app.get_options()) {
    const std::vector<std::string> names = names_of(*option);
    all.insert(all.end(), names.begin(), names.end());
  }
  return fmt::format("{}", fmt::join(all, " "));
}

// The words that a value may be, with spaces between them; empty: any text.
std::string words_of(const CLI::Option& option, const std::string& verbs) {
  const std::string type = option.get_type_name();
  if (type == "VERB") return verbs;
  return type.find('|') == std::string::npos ? std::string() : replaced(type, "|", " ");
}

constexpr const char* bash_head = R"(# Completion of the command dartcast for bash, printed by: dartcast completion bash
_dartcast() {
  local word="${COMP_WORDS[COMP_CWORD]}" before="${COMP_WORDS[COMP_CWORD - 1]}" words=""
  if [[ "$before" == "=" ]]; then before="${COMP_WORDS[COMP_CWORD - 2]}"; fi
  if [[ "$word" == "=" ]]; then word=""; fi
  case "$COMP_CWORD ${COMP_WORDS[1]} $before" in
)";

// Where nothing is found, bash completes files.
constexpr const char* bash_tail = R"(  esac
  COMPREPLY=($(compgen -W "$words" -- "$word"))
}
complete -o default -F _dartcast dartcast
)";

// A case for each option with known words, then one for all other options of the verb.
std::string bash_cases(const CLI::App& verb, const std::string& verbs) {
  std::string text;
  for (const CLI::Option* option : verb.get_options()) {
    const std::string words = words_of(*option, verbs);
    if (words.empty()) continue;
    if (option->get_positional()) {
      text += fmt::format("    \"2 {} \"*) words=\"{} {}\" ;;\n", verb.get_name(), words, joined_names(verb));
      continue;
    }
    for (const std::string& name : names_of(*option))
      text += fmt::format("    *\" {} {}\") words=\"{}\" ;;\n", verb.get_name(), name, words);
  }
  return text +
         fmt::format("    *\" {} \"*) [[ \"$word\" == -* ]] && words=\"{}\" ;;\n", verb.get_name(), joined_names(verb));
}

std::string bash_script(const CLI::App& app) {
  const std::vector<std::string> names = verbs_of(app);
  const std::string verbs = fmt::format("{}", fmt::join(names, " "));
  std::string text = bash_head + fmt::format("    \"1 \"*) words=\"{} {}\" ;;\n", verbs, joined_names(app));
  for (const std::string& name : names) text += bash_cases(*app.get_subcommand(name), verbs);
  return text + bash_tail;
}

// As a part of an argument of _arguments, in single quotes.
std::string zsh_text(std::string text) {
  for (const char* c : {"\\", "[", "]", ":"}) text = replaced(text, c, std::string("\\") + c);
  return replaced(text, "'", "'\\''");
}

std::string zsh_value(const CLI::Option& option, const std::string& verbs) {
  const std::string words = words_of(option, verbs);
  const std::string type = option.get_type_name();
  const std::string action = !words.empty() ? "(" + words + ")" : type == "N" || type == "SIZE" ? " " : "_files";
  return fmt::format("{}:{}", words.empty() ? type : "word", action);
}

std::string zsh_argument(const CLI::Option& option, const std::string& verbs) {
  if (option.get_positional()) {
    const bool is_list = option.get_expected_max() > 1;
    return fmt::format(" \\\n        '{}:{}'", is_list ? "*" : "", zsh_value(option, verbs));
  }
  const std::vector<std::string> names = names_of(option);
  const std::string value = option.get_expected_max() == 0 ? "" : ":" + zsh_value(option, verbs);
  std::string text;
  for (const std::string& name : names)
    text += fmt::format(" \\\n        '({}){}[{}]{}'", fmt::join(names, " "), name, zsh_text(option.get_description()),
                        value);
  return text;
}

// The file may lie in a folder of $fpath, or be read by eval.
std::string zsh_script(const CLI::App& app) {
  const std::string verbs = fmt::format("{}", fmt::join(verbs_of(app), " "));
  std::string list;
  std::string cases;
  for (const std::string& name : verbs_of(app)) {
    const CLI::App& verb = *app.get_subcommand(name);
    list += fmt::format("    '{}:{}'\n", name, zsh_text(verb.get_description()));
    cases += fmt::format("    {})\n      _arguments", name);
    for (const CLI::Option* option : verb.get_options()) cases += zsh_argument(*option, verbs);
    cases += " ;;\n";
  }
  return "#compdef dartcast\n# Completion of the command dartcast for zsh, printed by: dartcast completion zsh\n"
         "_dartcast() {\n  local -a verbs=(\n" +
         list +
         "  )\n  if ((CURRENT == 2)); then\n    _describe verb verbs\n    return\n  fi\n"
         "  ((CURRENT--))\n  shift words\n  case \"$words[1]\" in\n" +
         cases +
         "  esac\n}\n"
         "if [[ \"$funcstack[1]\" == _dartcast ]]; then _dartcast \"$@\"; else compdef _dartcast dartcast; fi\n";
}

}  // namespace

void add_completion(CLI::App& app, int& status) {
  const auto shell = std::make_shared<std::string>();
  const std::vector<std::string> shells = {"bash", "zsh"};
  CLI::App* verb = app.add_subcommand("completion", "Print what a shell needs to complete commands of dartcast.");
  verb->add_option("SHELL", *shell, "source <(dartcast completion bash) in ~/.bashrc turns it on; installed, it is on")
      ->required()
      ->check(one_of(shells))
      ->type_name(alternatives(shells));
  verb->callback([&app, shell, &status] {
    fmt::print("{}", *shell == "bash" ? bash_script(app) : zsh_script(app));
    status = done;
  });
}

void add_help(CLI::App& app, int& status) {
  const auto name = std::make_shared<std::string>();
  CLI::App* help = app.add_subcommand("help", "Print this overview, or the help of a verb.");
  help->add_option("VERB", *name, "the verb")->check(one_of(verbs_of(app)))->type_name("VERB");
  help->callback([&app, name, &status] {
    const CLI::App* verb = name->empty() ? &app : app.get_subcommand(*name);
    const std::string title = name->empty() ? app.get_name() : app.get_name() + " " + *name;
    fmt::print("{}", app.get_formatter()->make_help(verb, title, CLI::AppFormatMode::Normal));
    status = done;
  });
}

}  // namespace dartcast::app
