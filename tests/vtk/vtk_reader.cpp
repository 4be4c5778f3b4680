// A process that reads files by VTK: paths come in by lines, data sets go out as text (canonical.hpp), each ended by a
// line "end". Its crash is an answer, too. `vtk_reader FOLDER` writes files by VTK's writers instead.
#include <sys/resource.h>
#include <unistd.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
#include <vtkIntArray.h>
#include <vtkLogger.h>
#include <vtkLongLongArray.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkShortArray.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnsignedLongLongArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridReader.h>
#include <vtkUnstructuredGridWriter.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <iostream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "vtk/canonical.hpp"

namespace {

using dartcast::test::CanonicalText;

/// The first of VTK's complaints, in one line.
class Complaints : public vtkOutputWindow {
 public:
  static Complaints* New() { VTK_STANDARD_NEW_BODY(Complaints); }
  void DisplayText(const char* text) override { keep(text); }
  void DisplayErrorText(const char* text) override { keep(text); }
  void DisplayWarningText(const char* text) override { keep(text); }
  void DisplayGenericWarningText(const char* text) override { keep(text); }
  void DisplayDebugText(const char*) override {}

  std::string first;

 private:
  void keep(const char* text) {
    const std::string_view all = text;
    // Keys of metadata that it does not know are left out; the data are read.
    if (!first.empty() || all.find(" key ") != all.npos || all.find("InformationKey") != all.npos) return;
    first = text;
    std::replace(first.begin(), first.end(), '\n', ' ');
    first = " " + first.substr(std::min(first.find("): "), first.size()));
  }
};

// ---- reading

void add_points(vtkPointSet& set, CanonicalText& out) {
  out.line("points");
  for (vtkIdType i = 0; i < set.GetNumberOfPoints(); ++i) {
    double x[3];
    set.GetPoint(i, x);
    for (const double c : x) out.number(c);
  }
}

// Our .vtu files have texts as bytes, each ended by a 0.
bool is_text_in_bytes(vtkAbstractArray& array) {
  const std::string name = array.GetName() == nullptr ? "" : array.GetName();
  return array.GetDataType() == VTK_UNSIGNED_CHAR &&
         (name == "region_names" || name == "patch_names" || name == "free_written_by" || name == "baffle_patches");
}

void add_text_in_bytes(vtkDataArray& bytes, CanonicalText& out) {
  std::string text;
  for (vtkIdType i = 0; i < bytes.GetNumberOfTuples(); ++i) {
    const char c = static_cast<char>(bytes.GetComponent(i, 0));
    if (c != '\0') {
      text += c;
    } else {
      out.text(std::exchange(text, {}));
    }
  }
}

void add_arrays(const char* section, vtkFieldData& data, bool texts_alone, CanonicalText& out) {
  out.line(section);
  for (int a = 0; a < data.GetNumberOfArrays(); ++a) {
    vtkAbstractArray& array = *data.GetAbstractArray(a);
    const auto* name = array.GetName() == nullptr ? "" : array.GetName();
    if (auto* texts = vtkStringArray::SafeDownCast(&array)) {
      out.line(name);
      for (vtkIdType i = 0; i < texts->GetNumberOfValues(); ++i) out.text(texts->GetValue(i));
    } else if (texts_alone && is_text_in_bytes(array)) {
      out.line(name);
      add_text_in_bytes(*vtkDataArray::SafeDownCast(&array), out);
    } else if (auto* numbers = vtkDataArray::SafeDownCast(&array); numbers != nullptr && !texts_alone) {
      out.line(name);
      out.size(static_cast<std::size_t>(numbers->GetNumberOfComponents()));
      for (vtkIdType i = 0; i < numbers->GetNumberOfTuples(); ++i) {
        for (int k = 0; k < numbers->GetNumberOfComponents(); ++k) out.number(numbers->GetComponent(i, k));
      }
    }
  }
}

void add_faces(vtkUnstructuredGrid& grid, vtkIdType c, CanonicalText& out) {
  const auto points = static_cast<std::size_t>(grid.GetNumberOfPoints());
  vtkIdType count = 0;
  const vtkIdType* stream = nullptr;
  grid.GetFaceStream(c, count, stream);
  out.size(static_cast<std::size_t>(count));
  for (vtkIdType f = 0; f < count; ++f) {
    out.size(static_cast<std::size_t>(*stream));
    for (vtkIdType k = 1; k <= *stream; ++k) out.point(stream[k], points);
    stream += *stream + 1;
  }
}

void add_cells(vtkPointSet& set, vtkCellArray* cells, int type, CanonicalText& out) {
  if (cells == nullptr) return;
  if (!cells->IsValid()) throw std::runtime_error("offsets");
  auto* grid = vtkUnstructuredGrid::SafeDownCast(&set);
  for (vtkIdType c = 0; c < cells->GetNumberOfCells(); ++c) {
    const int own = type == 0 ? grid->GetCellType(c) : type;
    out.line(std::to_string(own));
    if (own == VTK_POLYHEDRON) {
      add_faces(*grid, c, out);
      continue;
    }
    vtkIdType size = 0;
    const vtkIdType* ids = nullptr;
    cells->GetCellAtId(c, size, ids);
    for (vtkIdType k = 0; k < size; ++k) out.point(ids[k], static_cast<std::size_t>(set.GetNumberOfPoints()));
  }
}

template <class Reader>
std::string read(const std::string& path) {
  vtkNew<Complaints> complaints;
  vtkOutputWindow::SetInstance(complaints);
  vtkNew<Reader> reader;
  if constexpr (std::is_same_v<Reader, vtkUnstructuredGridReader>) {
    reader->ReadAllScalarsOn();
    reader->ReadAllVectorsOn();
    reader->ReadAllNormalsOn();
    reader->ReadAllTensorsOn();
    reader->ReadAllColorScalarsOn();
    reader->ReadAllTCoordsOn();
    reader->ReadAllFieldsOn();
  }
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkPointSet* set = reader->GetOutput();
  if (!complaints->first.empty() || reader->GetErrorCode() != 0 || set == nullptr) return "refused" + complaints->first;
  CanonicalText out;
  add_points(*set, out);
  out.line("cells");
  if (auto* poly = vtkPolyData::SafeDownCast(set)) {
    add_cells(*set, poly->GetVerts(), VTK_POLY_VERTEX, out);
    add_cells(*set, poly->GetLines(), VTK_POLY_LINE, out);
    add_cells(*set, poly->GetPolys(), VTK_POLYGON, out);
    add_cells(*set, poly->GetStrips(), VTK_TRIANGLE_STRIP, out);
  } else {
    add_cells(*set, vtkUnstructuredGrid::SafeDownCast(set)->GetCells(), 0, out);
  }
  add_arrays("point_data", *set->GetPointData(), false, out);
  add_arrays("cell_data", *set->GetCellData(), false, out);
  add_arrays("field", *set->GetFieldData(), true, out);
  return out.text();
}

std::string answer(const std::string& path) {
  try {
    if (path.ends_with(".vtu")) return read<vtkXMLUnstructuredGridReader>(path);
    if (path.ends_with(".vtp")) return read<vtkXMLPolyDataReader>(path);
    return read<vtkUnstructuredGridReader>(path);
  } catch (const std::exception&) {
    return "refused";
  }
}

// ---- writing

template <class Array>
void add(vtkFieldData& to, const char* name, vtkIdType n, int components, double factor = 1.0) {
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(n);
  for (vtkIdType i = 0; i < n; ++i) {
    for (int k = 0; k < components; ++k) array->SetComponent(i, k, factor * static_cast<double>(7 * i + k + 1));
  }
  to.AddArray(array);
}

void add_texts(vtkFieldData& to, const char* name, vtkIdType n) {
  vtkNew<vtkStringArray> array;
  array->SetName(name);
  for (vtkIdType i = 0; i < n; ++i) array->InsertNextValue("a text, \xc3\xa4 " + std::to_string(i));
  to.AddArray(array);
}

void add_data(vtkPointSet& set) {
  const vtkIdType points = set.GetNumberOfPoints();
  const vtkIdType cells = set.GetNumberOfCells();
  vtkPointData& at_points = *set.GetPointData();
  add<vtkDoubleArray>(at_points, "heat", points, 1, 1.0 / 3.0);
  add<vtkFloatArray>(at_points, "a speed, 100%", points, 3, 0.1);
  add<vtkShortArray>(at_points, "short", points, 2, -1.0);
  add<vtkLongLongArray>(at_points, "long", points, 1, 1e12);
  add<vtkDoubleArray>(at_points, "stress", points, 9, 1e-3);
  add<vtkFloatArray>(at_points, "normals", points, 3, 0.01);
  at_points.SetActiveScalars("heat");
  at_points.SetActiveTensors("stress");
  at_points.SetActiveNormals("normals");
  vtkCellData& at_cells = *set.GetCellData();
  add<vtkIntArray>(at_cells, "region", cells, 1);
  add<vtkUnsignedCharArray>(at_cells, "byte", cells, 1);
  add<vtkUnsignedLongLongArray>(at_cells, "unsigned", cells, 1, 1e15);
  add<vtkFloatArray>(at_cells, "flow", cells, 3, -0.3);
  add_texts(at_cells, "names", cells);
  at_cells.SetActiveVectors("flow");
  add_texts(*set.GetFieldData(), "title", 2);
  add<vtkDoubleArray>(*set.GetFieldData(), "TimeValue", 1, 1);
}

void set_points(vtkPointSet& set, int type, const std::vector<double>& xyz) {
  vtkNew<vtkPoints> points;
  points->SetDataType(type);
  for (std::size_t i = 0; i < xyz.size(); i += 3) points->InsertNextPoint(xyz[i] / 3.0, xyz[i + 1], xyz[i + 2]);
  set.SetPoints(points);
}

const std::vector<double> cube = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1, 0.5, 0.5, 2};

vtkSmartPointer<vtkUnstructuredGrid> make_grid(int type, bool polyhedra) {
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  set_points(*grid, type, cube);
  const auto insert = [&](int cell, const std::vector<vtkIdType>& ids) {
    grid->InsertNextCell(cell, static_cast<vtkIdType>(ids.size()), ids.data());
  };
  insert(VTK_HEXAHEDRON, {0, 1, 2, 3, 4, 5, 6, 7});
  if (polyhedra) {
    const std::vector<vtkIdType> faces = {4, 4, 7, 6, 5, 3, 4, 5, 8, 3, 5, 6, 8, 3, 6, 7, 8, 3, 7, 4, 8};
    grid->InsertNextCell(VTK_POLYHEDRON, 5, faces.data());
  } else {
    insert(VTK_PYRAMID, {4, 5, 6, 7, 8});
  }
  insert(VTK_QUAD, {0, 1, 2, 3});
  insert(VTK_TRIANGLE, {4, 5, 8});
  insert(VTK_LINE, {0, 1});
  add_data(*grid);
  return grid;
}

vtkSmartPointer<vtkPolyData> make_surface(int type) {
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  set_points(*surface, type, cube);
  vtkNew<vtkCellArray> verts, lines, polys;
  verts->InsertNextCell({0});
  verts->InsertNextCell({1, 2});
  lines->InsertNextCell({0, 1, 2});
  polys->InsertNextCell({0, 3, 2, 1});
  polys->InsertNextCell({4, 5, 8});
  surface->SetVerts(verts);
  surface->SetLines(lines);
  surface->SetPolys(polys);
  add_data(*surface);
  return surface;
}

template <class Writer>
void write_xml(vtkDataObject& data, const std::string& stem, const char* ending) {
  for (const int mode : std::vector<int>{vtkXMLWriter::Ascii, vtkXMLWriter::Binary, vtkXMLWriter::Appended, 3}) {
    for (const auto compressor : {vtkXMLWriter::NONE, vtkXMLWriter::ZLIB, vtkXMLWriter::LZ4, vtkXMLWriter::LZMA}) {
      for (const int variant : {0, 1, 2}) {
        if (mode == vtkXMLWriter::Ascii && (compressor != vtkXMLWriter::NONE || variant != 0)) continue;
        vtkNew<Writer> writer;
        writer->SetDataMode(mode == 3 ? vtkXMLWriter::Appended : mode);
        writer->SetEncodeAppendedData(mode == 3 ? 1 : 0);
        writer->SetCompressorType(compressor);
        writer->SetBlockSize(256);
        writer->SetHeaderType(variant == 1 ? vtkXMLWriter::UInt32 : vtkXMLWriter::UInt64);
        if (variant == 2) writer->SetByteOrderToBigEndian();
        writer->SetInputData(&data);
        const std::string name = std::to_string(mode) + std::to_string(compressor) + std::to_string(variant);
        writer->SetFileName((stem + name + (compressor == vtkXMLWriter::LZMA ? "lzma." : ".") + ending).c_str());
        if (writer->Write() != 1) throw std::runtime_error("VTK cannot write");
      }
    }
  }
}

void write_all(const std::string& folder) {
  for (const int type : {VTK_FLOAT, VTK_DOUBLE}) {
    const std::string stem = folder + "/" + std::to_string(type) + "_";
    write_xml<vtkXMLPolyDataWriter>(*make_surface(type), stem + "s", "vtp");
    for (const bool polyhedra : {false, true}) {
      const auto grid = make_grid(type, polyhedra);
      const std::string own = stem + (polyhedra ? "p" : "g");
      write_xml<vtkXMLUnstructuredGridWriter>(*grid, own, "vtu");
      for (const int version : {42, 51}) {
        for (const int binary : {0, 1}) {
          vtkNew<vtkUnstructuredGridWriter> writer;
          writer->SetFileVersion(version);
          writer->SetFileType(binary == 1 ? VTK_BINARY : VTK_ASCII);
          writer->SetInputData(grid);
          writer->SetFileName((own + std::to_string(version) + std::to_string(binary) + ".vtk").c_str());
          if (writer->Write() != 1) throw std::runtime_error("VTK cannot write");
        }
      }
    }
  }
}

}  // namespace

int main(int count, char** arguments) {
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  const rlimit memory{rlim_t{4} << 30U, rlim_t{4} << 30U};
  ::setrlimit(RLIMIT_AS, &memory);
  const rlimit core{0, 0};
  ::setrlimit(RLIMIT_CORE, &core);
  if (count > 1) {
    write_all(arguments[1]);
    return 0;
  }
  for (std::string path; std::getline(std::cin, path);) {
    ::alarm(60);
    std::cout << answer(path) << "\nend" << std::endl;
  }
}
