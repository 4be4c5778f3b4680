// VTK files whose structure is damaged: sections and arrays that occur twice, nowhere, elsewhere, or under other names.
// VTK's readers find them by name and by order.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_files.hpp"
#include "formats/point_file.hpp"
#include "output/mesh_report_text.hpp"
#include "support/shared_data.hpp"
#include "support/tier.hpp"
#include "support/vtk_files.hpp"

namespace dartcast::test::hostile_structure_test {

/// An element of an XML text: from its first '<' to behind its end.
struct Element {
  std::string name;
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// All elements but the appended data and the whole file.
std::vector<Element> elements_of(const std::string& xml) {
  std::vector<Element> done;
  std::vector<Element> open;
  const std::size_t limit = std::min(xml.find("<AppendedData"), xml.size());
  for (std::size_t at = xml.find('<'); at < limit; at = xml.find('<', at + 1)) {
    const std::size_t end = xml.find('>', at) + 1;
    if (xml[at + 1] == '?') continue;
    if (xml[at + 1] == '/') {
      if (open.empty()) break;
      done.push_back({open.back().name, open.back().begin, end});
      open.pop_back();
      continue;
    }
    const std::string name = xml.substr(at + 1, xml.find_first_of(" >/", at + 1) - at - 1);
    if (name == "VTKFile") continue;
    if (xml[end - 2] == '/') {
      done.push_back({name, at, end});
    } else {
      open.push_back({name, at, 0});
    }
  }
  return done;
}

/// The text with [begin, end) replaced.
std::string replaced(const std::string& text, std::size_t begin, std::size_t end, const std::string& by) {
  return std::string(text).replace(begin, end - begin, by);
}

template <class Take>
void for_each_copy(const std::string& xml, Take&& take) {
  const auto elements = elements_of(xml);
  for (const Element& e : elements) {
    const std::string text = xml.substr(e.begin, e.end - e.begin);
    take(replaced(xml, e.end, e.end, text), "twice: " + e.name);
    take(replaced(xml, e.begin, e.end, ""), "without: " + e.name);
    for (const Element& to : elements) {
      take(replaced(xml, to.end, to.end, text), e.name + " copied behind " + to.name);
      const std::size_t inside = xml.find('>', to.begin) + 1;
      if (inside < to.end) take(replaced(xml, inside, inside, text), e.name + " copied into " + to.name);
      if (to.begin >= e.end) {
        take(replaced(replaced(xml, to.end, to.end, text), e.begin, e.end, ""), e.name + " moved behind " + to.name);
      }
    }
  }
}

/// Every attribute's value replaced, and the attribute removed.
template <class Take>
void for_each_value(const std::string& xml, const std::string& key, const std::vector<std::string>& values,
                    Take&& take) {
  const std::string mark = " " + key + "=\"";
  for (std::size_t at = xml.find(mark); at != std::string::npos; at = xml.find(mark, at + 1)) {
    const std::size_t begin = at + mark.size();
    const std::size_t end = xml.find('"', begin);
    take(replaced(xml, at, end + 1, ""), "without: " + key);
    for (const std::string& value : values) take(replaced(xml, begin, end, value), fmt::format("{}={}", key, value));
  }
}

template <class Take>
void for_each_damage(const std::string& xml, Take&& take) {
  for_each_copy(xml, take);
  for_each_value(xml, "Name",
                 {"", "free", "region", "heat", "&#102;ree", "connectivity", "offsets", "types", "faces", "faceoffsets",
                  "Points", "vtkGhostType", "vtkGhostLevels", "vtkOriginalCellIds", "a>b", "vtkQSA"},
                 take);
  for_each_value(xml, "type", {"Int8", "UInt8", "Int64", "Float32", "Float64", "String", "Bit", "PolyData"}, take);
  for_each_value(xml, "NumberOfComponents", {"0", "1", "2", "9", "1000000"}, take);
  for_each_value(xml, "NumberOfTuples", {"0", "2", "1000000000000"}, take);
  for_each_value(xml, "NumberOfPoints", {"0", "1", "13"}, take);
  for_each_value(xml, "NumberOfCells", {"0", "1", "3"}, take);
  for_each_value(xml, "Scalars", {"", "free", "nothing"}, take);
  for (const Element& e : elements_of(xml)) {
    const std::size_t behind_name = e.begin + 1 + e.name.size();
    for (const char* more : {" TimeValues=\"0 1\"", " TimeStep=\"0\"", " Vectors=\"flow\"", " GlobalIds=\"free\"",
                             " Name=\"free\"", " a=\">\""})
      take(replaced(xml, behind_name, behind_name, more), e.name + more);
    for (const char* name :
         {"Array", "DataArray", "Piece", "Points", "PointData", "CellData", "Cells", "FieldData", "Verts", "Other"}) {
      std::string text = replaced(xml, e.begin + 1, behind_name, name);
      const std::string closing = "</" + e.name + ">";
      const std::size_t last = e.end - e.name.size() + std::string(name).size();
      if (xml[e.end - 2] != '/') text = replaced(text, last - 1 - std::string(name).size(), last - 1, name);
      take(text, e.name + " as " + name);
    }
  }
}

class HostileStructure : public testing::Test {
 protected:
  /// Reads the content; what is accepted must hold up when it is inspected again.
  void read_as_mesh(const std::string& name, const std::string& content, const std::string& how) {
    MeshFile file = read_mesh(folder_.file(name, content));
    if (!file.report.valid()) {
      EXPECT_FALSE(file.report.defects[0].message.empty()) << how;
      return;
    }
    ++accepted_;
    const MeshReport again = check_and_repair(file.mesh);
    EXPECT_TRUE(again.valid() && again.repairs.empty()) << how << "\n" << report_text(again);
    std::set<std::string> names;
    for (const DataArray& a : file.mesh.cell_data) EXPECT_TRUE(names.insert(a.name).second) << how << ": " << a.name;
  }

  std::string refusal(const std::string& name, const std::string& content) {
    const MeshReport report = read_mesh(folder_.file(name, content)).report;
    return report.valid() ? "accepted" : report.defects[0].message;
  }

  Folder folder_;
  int accepted_ = 0;
};

TEST_F(HostileStructure, VtuOfEveryDataAndInPieces) {
  for (const XmlData how : xml_data_kinds()) {
    for (const std::string& xml : {cubes_vtu(how), cubes_vtu(how, 2), cubes_vtu(how, 1, false)}) {
      accepted_ = 0;
      read_as_mesh("a.vtu", xml, "whole");
      EXPECT_EQ(accepted_, 1) << refusal("a.vtu", xml);
      const bool sampled = how != XmlData::ascii && xml.find("NumberOfPoints=\"8\"") != std::string::npos;
      const std::size_t each = sampled ? stride(5, 40) : stride(1, 8);
      std::size_t n = 0;
      for_each_damage(xml, [&](const std::string& content, const std::string& what) {
        if (n++ % each == 0) read_as_mesh("a.vtu", content, what);
      });
    }
  }
}

// VTK's own compressed files; where their data are damaged it looks for names of sections that need not be there.
TEST_F(HostileStructure, VtuCompressed) {
  MeshData mesh = sample_mesh();
  mesh.cell_data = {{"heat", 1, {1, 2, 3, 4}}};
  write_mesh(mesh, folder_ / "b.vtu");
  std::string xml = slurp(folder_ / "b.vtu");
  std::size_t n = 0;
  for_each_damage(xml, [&](const std::string& content, const std::string& what) {
    if (n++ % stride(1, 8) == 0) read_as_mesh("b.vtu", content, what);
  });
  const std::size_t begin = xml.find("<PointData");
  xml = replaced(xml, begin, xml.find("</PointData>") + 12, "");
  read_as_mesh("b.vtu", xml, "without point data");
  EXPECT_GT(accepted_, 0);
  for (std::size_t at = xml.find('_'); at < xml.size(); at += stride(1, 3)) {
    read_as_mesh("b.vtu", replaced(xml, at, at + 1, "A"), "byte " + std::to_string(at));
  }
}

TEST_F(HostileStructure, VtpOfEveryData) {
  for (const XmlData how : xml_data_kinds()) {
    const std::string xml = points_vtp(how);
    const PointFile whole = read_points(folder_.file("a.vtp", xml));
    EXPECT_EQ(whole.points.size(), 3U);
    EXPECT_EQ(whole.arrays.size(), 2U);
    for_each_damage(xml, [&](const std::string& content, const std::string& what) {
      try {
        const PointFile file = read_points(folder_.file("a.vtp", content));
        for (const DataArray& a : file.arrays) EXPECT_EQ(a.values.size(), file.points.size() * a.components) << what;
      } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("a.vtp"), std::string::npos) << what;
      }
    });
  }
}

TEST_F(HostileStructure, LegacyOfEitherData) {
  for (const bool binary : {false, true}) {
    const std::vector<std::string> sections = cubes_vtk_sections(binary);
    EXPECT_EQ(refusal("a.vtk", joined(sections)), "accepted");
    for (std::size_t i = 1; i < sections.size(); ++i) {
      auto without = sections;
      without.erase(without.begin() + static_cast<std::ptrdiff_t>(i));
      read_as_mesh("a.vtk", joined(without), "without section " + std::to_string(i));
      for (std::size_t j = 1; j <= sections.size(); ++j) {
        auto copied = sections;
        copied.insert(copied.begin() + static_cast<std::ptrdiff_t>(j), sections[i]);
        read_as_mesh("a.vtk", joined(copied), "a copy of section " + std::to_string(i) + " at " + std::to_string(j));
      }
    }
    const std::string whole = joined(sections);
    for (const std::string name : {"region", "flow", "free", "heat", "speed", "TimeValue", "default", "FieldData"}) {
      for (const std::string& other :
           {std::string("heat"), std::string("h%65at"), std::string("heat%"), std::string("free"),
            std::string("default"), std::string("NULL_ARRAY"), std::string("METADATA"), std::string("metadata1"),
            std::string("\xff"), std::string("%"), std::string("%4"), std::string("%zz"), std::string("a%00b"),
            std::string(300, 'x')}) {
        for (std::size_t at = whole.find(name); at != std::string::npos; at = whole.find(name, at + 1))
          read_as_mesh("a.vtk", replaced(whole, at, at + name.size(), other), fmt::format("{} as {}", name, other));
      }
    }
  }
}

/// Where the array `heat` of <section> stands twice.
std::string with_copy(const std::string& xml, const std::string& section, const std::string& array) {
  const std::size_t from = xml.find("<" + section);
  std::size_t begin = xml.find("Name=\"" + array, from);
  begin = xml.rfind('<', begin);
  std::size_t end = xml.find("/>", begin) + 2;
  const std::size_t closing = xml.find("</DataArray>", begin);
  if (xml.find('>', begin) + 1 != end) end = closing + 12;
  return replaced(xml, end, end, xml.substr(begin, end - begin));
}

// Names and values that stand behind an array: VTK reads so many as it has components, and over empty lines.
TEST_F(HostileStructure, LegacyMetadata) {
  const std::string metadata =
      "METADATA\nCOMPONENT_NAMES\nx%20axis\ny\nz\nINFORMATION 2\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 "
      "1.5\nNAME UNITS_LABEL LOCATION vtkDataArray\nDATA mm%2fs\n\n";
  for (const bool binary : {false, true}) {
    auto sections = cubes_vtk_sections(binary);
    sections.insert(sections.begin() + 8, metadata);
    EXPECT_EQ(refusal("a.vtk", joined(sections)), "accepted");
    const auto changed = [&](const std::string& from, const std::string& to) {
      auto other = sections;
      other[8] = replaced(metadata, metadata.find(from), metadata.find(from) + from.size(), to);
      return refusal("a.vtk", joined(other));
    };
    for (const char* name : {"%", "%4", "%zz", "%00"}) EXPECT_NE(changed("y", name).find("'%'"), std::string::npos);
    for (const char* data : {"DATA 3 0 1.5", "DATA 2147483647 0", "DATA -1 0", "DATA 2 0", "DATA", "DATA 2 0 1.5 7"})
      EXPECT_NE(changed("DATA 2 0 1.5", data), "accepted") << data;
    for (const char* keys : {"INFORMATION 3", "INFORMATION 1", "INFORMATION 1000000000", "INFORMATION x", "INFO 2"})
      EXPECT_NE(changed("INFORMATION 2", keys), "accepted") << keys;
    EXPECT_NE(changed("L2_NORM_RANGE", "CONSUMER").find("is not known in METADATA"), std::string::npos);
    EXPECT_NE(changed("z\nINFO", "INFO"), "accepted");
    for (std::size_t at = 0; at < metadata.size(); ++at) {
      for (const std::string& by : {std::string("\n"), std::string("%"), std::string("9"), std::string(300, 'x')}) {
        auto other = sections;
        other[8] = replaced(metadata, at, at + 1, by);
        read_as_mesh("a.vtk", joined(other), "metadata at " + std::to_string(at));
      }
    }
  }
}

TEST_F(HostileStructure, RepeatedNamesAreRefusedInWords) {
  for (const XmlData how : xml_data_kinds()) {
    const std::string xml = cubes_vtu(how);
    for (const auto& [section, array] : std::vector<std::pair<std::string, std::string>>{{"CellData", "free"},
                                                                                         {"CellData", "flow"},
                                                                                         {"PointData", "speed"},
                                                                                         {"FieldData", "title"},
                                                                                         {"Points", "Points"},
                                                                                         {"Cells", "types"},
                                                                                         {"Cells", "offsets"}}) {
      const std::string message = refusal("a.vtu", with_copy(xml, section, array));
      EXPECT_NE(message.find(fmt::format("a second array '{}' in <{}>", array, section)), std::string::npos) << message;
    }
    // The same name in two sections is none of a name twice.
    std::string both = xml;
    const std::size_t at = both.find("Name=\"flow\"");
    EXPECT_EQ(refusal("a.vtu", both.replace(at, 11, "Name=\"heat\"")), "accepted");
    EXPECT_THROW((void)read_points(folder_.file("a.vtp", with_copy(points_vtp(how), "PointData", "radius"))), Error);
  }
  for (const bool binary : {false, true}) {
    auto sections = cubes_vtk_sections(binary);
    sections.insert(sections.begin() + 9, sections[6]);
    const std::string message = refusal("a.vtk", joined(sections));
    EXPECT_NE(message.find("a second array 'region' at the cells"), std::string::npos) << message;
  }
}

TEST_F(HostileStructure, FilesThatCrashedAreRefused) {
  NEED_DATA("files that crashed VTK's reader");
  for (const char* data : {"ascii", "b64", "inline", "raw"}) {
    const auto path = data_folder() / "regressions" / ("dup_h_" + std::string(data) + "_4_0.vtu");
    const MeshReport report = read_mesh(path).report;
    ASSERT_FALSE(report.valid()) << path;
    EXPECT_NE(report.defects[0].message.find("a second array 'free'"), std::string::npos) << report.defects[0].message;
  }
}

}  // namespace dartcast::test::hostile_structure_test
