// The results of a run, in words and tables.
#include "report/run_results.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include "report/chart.hpp"
#include "report/grouped.hpp"
#include "report/summary_file.hpp"

namespace dartcast {

std::string run_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

RunJson run_summary(const std::filesystem::path& folder) {
  RunJson json = RunJson::parse(run_text(folder / "summary.json"), nullptr, false);
  return json.is_object() ? json : RunJson::object();
}

std::uint64_t count_in(const RunJson& summary, const char* path) {
  const RunJson::json_pointer at(path);
  if (!summary.contains(at)) return 0;
  const RunJson& n = summary.at(at);
  return n.is_number_unsigned() ? n.get<std::uint64_t>() : 0;
}

namespace {

namespace fs = std::filesystem;

// A value in words: lists of numbers as coordinates.
std::string value_text(const RunJson& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_null()) return "not counted";
  if (value.is_number_unsigned()) return grouped(value.get<std::uint64_t>());
  if (value.is_number()) return fmt::format("{:.4g}", value.get<double>());
  std::string out;
  for (const auto& [name, part] : value.items()) {
    if (!out.empty()) out += ", ";
    const bool nested = part.is_structured();
    out += (value.is_object() ? name + " " : "") + (nested ? "(" : "") + value_text(part) + (nested ? ")" : "");
  }
  return out;
}

std::string name_text(std::string name) {
  for (char& c : name) {
    if (c == '_') c = ' ';
  }
  return name.empty() ? "no patch" : name;
}

class ResultTable {
 public:
  ResultTable(std::string_view title, std::initializer_list<std::string> head) : title_(title), head_(head) {}

  void row(std::vector<std::string> fields) { rows_.push_back(std::move(fields)); }
  [[nodiscard]] std::string text() const {
    if (rows_.empty()) return {};
    std::string out = fmt::format("<div class=\"table\"><h3>{}</h3><div class=\"wide\"><table>\n<tr>", html(title_));
    for (const std::string& field : head_) out += "<th scope=\"col\">" + html(field) + "</th>";
    out += "</tr>\n";
    for (const auto& fields : rows_) {
      out += "<tr>";
      for (std::size_t i = 0; i < fields.size(); ++i)
        out += i == 0 ? "<th scope=\"row\">" + html(fields[i]) + "</th>" : "<td>" + html(fields[i]) + "</td>";
      out += "</tr>\n";
    }
    return out + "</table></div></div>\n";
  }

 private:
  std::string title_;
  std::vector<std::string> head_;
  std::vector<std::vector<std::string>> rows_;
};

// The time of the last step. s
double end_time(const fs::path& folder) {
  const std::string text = run_text(folder / "stats.csv");
  const std::string_view all = std::string_view(text).substr(0, text.find_last_not_of('\n') + 1);
  const std::string last(all.substr(all.rfind('\n') + 1));
  const std::size_t comma = last.find(',');
  return comma == std::string::npos ? 0.0 : std::strtod(last.c_str() + comma + 1, nullptr);
}

std::string counted(std::uint64_t n, std::string_view one) {
  return fmt::format("{} {}{}", grouped(n), one, n == 1 ? "" : "s");
}

// "; 12 left (a 7, b 5)"
std::string by_patch(const RunJson& summary, const char* kind) {
  std::string out;
  const RunJson all = summary.value("deposition", RunJson::object());
  for (const auto& [patch, values] : all.items()) {
    const std::uint64_t n = count_in(values, kind);
    if (n > 0) out += fmt::format("{}{} {}", out.empty() ? "" : ", ", name_text(patch), grouped(n));
  }
  return out.empty() ? out : " (" + out + ")";
}

ResultTable fates(const RunJson& summary) {
  ResultTable table("What became of the particles", {"", "particles", "share"});
  const std::uint64_t all = count_in(summary, "/particles/start") + count_in(summary, "/particles/injected");
  const std::pair<const char*, const char*> kinds[] = {
      {"injected", "came in later"},      {"escaped", "left"},
      {"absorbed", "were deposited"},     {"alive", "in the scene at the end"},
      {"held", "held in inverted cells"}, {"lost", "lost"}};
  if (all == 0) return table;
  table.row({"all", grouped(all), "100%"});
  for (const auto& [key, text] : kinds) {
    const std::uint64_t n = count_in(summary, fmt::format("/particles/{}", key).c_str());
    if (n > 0)
      table.row({text, grouped(n), fmt::format("{:.3g}%", 100.0 * static_cast<double>(n) / static_cast<double>(all))});
  }
  return table;
}

ResultTable patches(const RunJson& summary) {
  ResultTable table("Walls by patch", {"patch", "contacts", "deposited", "share", "per m²", "left"});
  const RunJson deposition = summary.value("deposition", RunJson::object());
  const RunJson contacts = summary.value("/contacts/by_patch"_json_pointer, RunJson::object());
  for (const auto& [patch, met] : contacts.items()) {
    const RunJson d = deposition.value(patch, RunJson::object());
    const auto value = [&](const char* key) { return d.contains(key) ? value_text(d[key]) : "0"; };
    if (met != 0 || count_in(d, "/deposited") + count_in(d, "/escaped") > 0)
      table.row({name_text(patch), value_text(met), value("deposited"), value("fraction"), value("per_area"),
                 value("escaped")});
  }
  return table;
}

// Times that particles were in the scene until they left it, or until they were deposited.
ResultTable times(const RunJson& summary) {
  ResultTable table("Time in the scene (s)", {"", "particles", "mean", "least", "most"});
  const RunJson all = summary.value("/statistics/residence_time"_json_pointer, RunJson::object());
  for (const char* kind : {"escaped", "absorbed"}) {
    const RunJson by_patch = all.value(kind, RunJson::object());
    for (const auto& [patch, t] : by_patch.items())
      table.row({fmt::format("{} {}", kind == std::string_view("escaped") ? "left through" : "deposited at",
                             name_text(patch)),
                 value_text(t.value("count", RunJson(0U))), value_text(t.value("mean", RunJson())),
                 value_text(t.value("least", RunJson())), value_text(t.value("most", RunJson()))});
  }
  return table;
}

// A list of objects: a row for each, a column for each member.
std::string list_table(std::string_view title, const RunJson& list) {
  if (!list.is_array() || list.empty() || !list.front().is_object()) return {};
  std::vector<std::string> keys;
  for (const RunJson& one : list) {
    for (const auto& [key, value] : one.items()) {
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
    }
  }
  std::string out = fmt::format("<div class=\"table\"><h3>{}</h3><div class=\"wide\"><table>\n<tr>", html(title));
  for (const std::string& key : keys) out += "<th scope=\"col\">" + html(name_text(key)) + "</th>";
  out += "</tr>\n";
  for (const RunJson& one : list) {
    out += "<tr>";
    for (const std::string& key : keys)
      out += "<td>" + html(one.contains(key) ? value_text(one[key]) : std::string()) + "</td>";
    out += "</tr>\n";
  }
  return out + "</table></div></div>\n";
}

// Rows of an object; objects in it are headed by their name. Long lists stay in the file.
void add_rows(std::string& out, const RunJson& object, const std::string& path, std::size_t depth) {
  for (const auto& [name, value] : object.items()) {
    const std::string key = path.empty() ? name_text(name) : fmt::format("{}, {}", path, name_text(name));
    if (value.is_object() && depth < 4) {
      add_rows(out, value, key, depth + 1);
    } else if (!value.is_array() || (value.size() <= 3 && !value.empty() && !value.front().is_object())) {
      out += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", html(key), html(value_text(value)));
    }
  }
}

// When the run wrote its summary, in UTC.
std::string date_of(const fs::path& file) {
  std::error_code error;
  const fs::file_time_type written = fs::last_write_time(file, error);
  if (error) return {};
  const auto seconds = std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::file_clock::to_sys(written));
  return fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::chrono::system_clock::to_time_t(seconds)));
}

}  // namespace

std::string run_caption(const fs::path& folder) {
  const RunJson s = run_summary(folder);
  if (s.empty()) return {};
  const std::uint64_t start = count_in(s, "/particles/start");
  const std::uint64_t injected = count_in(s, "/particles/injected");
  std::string out = start + injected > 0 ? counted(start, "particle") : std::string("A scene");
  if (injected > 0) out += fmt::format(", and {} that came in later,", grouped(injected));
  out += fmt::format(" moved for {:.4g} s ({}) through {}", end_time(folder), counted(count_in(s, "/steps"), "step"),
                     counted(count_in(s, "/environment/free_cells"), "cell"));
  out += fmt::format(" with {}.", counted(count_in(s, "/environment/wall_faces"), "wall face"));
  if (const std::uint64_t n = count_in(s, "/contacts/total"); n > 0)
    out += fmt::format(" They met the walls {} times.", grouped(n));
  std::string ends;
  if (const std::uint64_t n = count_in(s, "/particles/escaped"); n > 0)
    ends += fmt::format("{} left{}, ", grouped(n), by_patch(s, "/escaped"));
  if (const std::uint64_t n = count_in(s, "/particles/absorbed"); n > 0)
    ends += fmt::format("{} were deposited{}, ", grouped(n), by_patch(s, "/deposited"));
  if (start + injected > 0)
    out += fmt::format(" {}{} were in the scene at the end.", ends, grouped(count_in(s, "/particles/alive")));
  return out;
}

std::string run_results(const fs::path& folder) {
  const RunJson s = run_summary(folder);
  const std::string tables =
      fates(s).text() + patches(s).text() + times(s).text() +
      list_table("Planes", s.value("/statistics/planes"_json_pointer, RunJson())) +
      list_table("Bodies", s.value("bodies", RunJson())) + list_table("Catheters", s.value("catheters", RunJson())) +
      list_table("Solids", s.value("tools", RunJson())) + list_table("Events", s.value("events", RunJson()));
  return tables.empty() ? tables : "<section class=\"tables\" aria-label=\"Results\">\n" + tables + "</section>\n";
}

std::string run_origin(const fs::path& folder) {
  const RunJson s = run_summary(folder);
  const std::string scene = run_text(folder / "scene.toml");
  std::string out;
  if (!s.empty()) {
    out += fmt::format("<p class=\"notes\">dartcast {}, {}. State hash {}.",
                       html(value_text(s.value("version", RunJson("")))), html(date_of(folder / "summary.json")),
                       html(value_text(s.value("state_hash", RunJson("")))));
    if (!scene.empty())
      out += fmt::format(" The same run again: <code>dartcast run scene.toml --steps {}</code>", count_in(s, "/steps"));
    out += "</p>\n";
    std::string rows;
    add_rows(rows, s, "", 0);
    out += "<details><summary>All numbers</summary><div class=\"wide\"><table>\n" + rows + "</table></div></details>\n";
  }
  if (!scene.empty()) out += "<details><summary>Scene (scene.toml)</summary><pre>" + html(scene) + "</pre></details>\n";
  return out;
}

}  // namespace dartcast
