// VTKHDF by the C library of HDF5. Every array is one data set that grows frame by frame, and Steps says where the parts
// of each frame begin. The walls are written in each frame: VTK finds cells by counting those of the frames before.
#include "output/vtkhdf.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"

#ifdef DARTCAST_HDF5
#include <hdf5.h>
#endif

namespace dartcast {

#ifdef DARTCAST_HDF5

namespace {

// A handle of HDF5, closed at its end.
class HdfHandle {
 public:
  HdfHandle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {
    if (id < 0) throw Error("HDF5 reports an error");
  }
  HdfHandle(HdfHandle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  HdfHandle(const HdfHandle&) = delete;
  HdfHandle& operator=(const HdfHandle&) = delete;
  HdfHandle& operator=(HdfHandle&&) = delete;
  ~HdfHandle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): HDF5's functions take it

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void expect_done(herr_t status) {
  if (status < 0) throw Error("HDF5 reports an error");
}

template <class T>
hid_t hdf_type() {
  if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
  if constexpr (std::is_same_v<T, std::uint8_t>) return H5T_NATIVE_UINT8;
}

// A data set of rows that is appended to.
class GrowingArray {
 public:
  GrowingArray(hid_t file, const std::string& name, hid_t type, hsize_t columns)
      : type_(type), columns_(columns), set_(make(file, name), H5Dclose) {}

  [[nodiscard]] std::int64_t rows() const { return static_cast<std::int64_t>(rows_); }

  template <class T>
  void append(std::span<const T> values) {
    if (values.empty()) return;
    const hsize_t more = values.size() / columns_;
    const std::array<hsize_t, 2> from = {rows_, 0};
    const std::array<hsize_t, 2> count = {more, columns_};
    rows_ += more;
    const std::array<hsize_t, 2> size = {rows_, columns_};
    expect_done(H5Dset_extent(set_, size.data()));
    const HdfHandle to(H5Dget_space(set_), H5Sclose);
    expect_done(H5Sselect_hyperslab(to, H5S_SELECT_SET, from.data(), nullptr, count.data(), nullptr));
    const HdfHandle memory(H5Screate_simple(rank(), count.data(), nullptr), H5Sclose);
    expect_done(H5Dwrite(set_, type_, memory, to, H5P_DEFAULT, values.data()));
  }
  template <class T>
  void append(std::initializer_list<T> values) {
    append(std::span<const T>(values.begin(), values.size()));
  }

 private:
  [[nodiscard]] int rank() const { return columns_ > 1 ? 2 : 1; }

  hid_t make(hid_t file, const std::string& name) const {
    constexpr hsize_t rows_in_chunk = 8192;
    const std::array<hsize_t, 2> none = {0, columns_};
    const std::array<hsize_t, 2> any = {H5S_UNLIMITED, columns_};
    const std::array<hsize_t, 2> chunk = {rows_in_chunk, columns_};
    const HdfHandle space(H5Screate_simple(rank(), none.data(), any.data()), H5Sclose);
    const HdfHandle made(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    expect_done(H5Pset_chunk(made, rank(), chunk.data()));
    expect_done(H5Pset_shuffle(made));
    expect_done(H5Pset_deflate(made, 4));
    const HdfHandle groups(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    expect_done(H5Pset_create_intermediate_group(groups, 1));
    return H5Dcreate2(file, name.c_str(), type_, space, groups, made, H5P_DEFAULT);
  }

  hid_t type_;
  hsize_t columns_;
  hsize_t rows_ = 0;
  HdfHandle set_;
};

constexpr std::array<const char*, 4> topologies = {"Vertices", "Lines", "Polygons", "Strips"};

class VtkHdfFile {
 public:
  explicit VtkHdfFile(const std::filesystem::path& path)
      : file_(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose),
        root_(H5Gcreate2(file_, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose),
        steps_(H5Gcreate2(root_, "Steps", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose) {
    const std::array<std::int64_t, 2> version = {2, 0};
    add_attribute(root_, "Version", H5T_NATIVE_INT64, 2, version.data());
    const std::string kind = "PolyData";
    const HdfHandle text(H5Tcopy(H5T_C_S1), H5Tclose);
    expect_done(H5Tset_size(text, kind.size()));
    const HdfHandle one(H5Screate(H5S_SCALAR), H5Sclose);
    const HdfHandle type(H5Acreate2(root_, "Type", text, one, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    expect_done(H5Awrite(type, text, kind.data()));
  }

  void add(const RunFrame& frame, const RunWalls& walls, bool lines) {
    const std::size_t of_walls = walls.points.size();
    const std::size_t n = of_walls + frame.points.size();
    std::array<std::int64_t, 4> cells{};
    std::array<std::int64_t, 4> ids{};
    for (std::size_t t = 0; t < 4; ++t) {
      cells[t] = cells_[t];
      ids[t] = array<std::int64_t>(topology(t, "Connectivity")).rows();
    }
    array<double>("Steps/Values").append({frame.time});
    array<std::int64_t>("Steps/PartOffsets").append({count_});
    array<std::int64_t>("Steps/NumberOfParts").append({std::int64_t{1}});
    array<std::int64_t>("Steps/PointOffsets").append({array<double>("Points", 3).rows()});
    array<std::int64_t>("Steps/CellOffsets", 4).append(std::span<const std::int64_t>(cells));
    array<std::int64_t>("Steps/ConnectivityIdOffsets", 4).append(std::span<const std::int64_t>(ids));
    for (const char* name : {"velocity", "radius", "id", "is_particle"})
      array<std::int64_t>(std::string("Steps/PointDataOffsets/") + name).append({array<double>("Points", 3).rows()});

    array<std::int64_t>("NumberOfPoints").append({static_cast<std::int64_t>(n)});
    std::vector<Vec3> points = walls.points;
    points.insert(points.end(), frame.points.begin(), frame.points.end());
    std::vector<Vec3> velocities(of_walls);
    velocities.insert(velocities.end(), frame.velocities.begin(), frame.velocities.end());
    std::vector<double> radii(of_walls);
    radii.insert(radii.end(), frame.radii.begin(), frame.radii.end());
    std::vector<std::int64_t> numbers(of_walls, -1);
    numbers.insert(numbers.end(), frame.ids.begin(), frame.ids.end());
    std::vector<std::uint8_t> marks(of_walls, 0);
    marks.resize(n, 1);
    array<double>("Points", 3).append(doubles(points));
    array<double>("PointData/velocity", 3).append(doubles(velocities));
    array<double>("PointData/radius").append(std::span<const double>(radii));
    array<std::int64_t>("PointData/id").append(std::span<const std::int64_t>(numbers));
    array<std::uint8_t>("PointData/is_particle").append(std::span<const std::uint8_t>(marks));

    std::vector<std::int64_t> particles;
    std::vector<std::int64_t> ends = {0};
    for (std::size_t i = of_walls; i < n; ++i) {
      particles.push_back(static_cast<std::int64_t>(i));
      ends.push_back(static_cast<std::int64_t>(particles.size()));
    }
    add_cells(0, particles, ends);
    const std::vector<std::int64_t> corners(walls.corners.begin(), walls.corners.end());
    const std::vector<std::int64_t> offsets(walls.offsets.begin(), walls.offsets.end());
    add_cells(1, lines ? corners : std::vector<std::int64_t>(), lines ? offsets : std::vector<std::int64_t>{0});
    add_cells(2, lines ? std::vector<std::int64_t>() : corners, lines ? std::vector<std::int64_t>{0} : offsets);
    add_cells(3, {}, {0});
    ++count_;
  }

  void finish() { add_attribute(steps_, "NSteps", H5T_NATIVE_INT64, 1, &count_); }

 private:
  static std::span<const double> doubles(const std::vector<Vec3>& v) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    return {reinterpret_cast<const double*>(v.data()), 3 * v.size()};
  }
  static std::string topology(std::size_t t, const char* name) { return std::string(topologies[t]) + "/" + name; }

  void add_cells(std::size_t t, const std::vector<std::int64_t>& corners, const std::vector<std::int64_t>& offsets) {
    const auto count = static_cast<std::int64_t>(offsets.size()) - 1;
    array<std::int64_t>(topology(t, "NumberOfCells")).append({count});
    array<std::int64_t>(topology(t, "NumberOfConnectivityIds")).append({static_cast<std::int64_t>(corners.size())});
    array<std::int64_t>(topology(t, "Connectivity")).append(std::span<const std::int64_t>(corners));
    array<std::int64_t>(topology(t, "Offsets")).append(std::span<const std::int64_t>(offsets));
    cells_[t] += count;
  }

  // Made when it is asked for first.
  template <class T>
  GrowingArray& array(const std::string& name, hsize_t columns = 1) {
    const auto found = arrays_.find(name);
    return found != arrays_.end() ? found->second
                                  : arrays_.try_emplace(name, root_, name, hdf_type<T>(), columns).first->second;
  }

  static void add_attribute(hid_t group, const char* name, hid_t type, hsize_t size, const void* values) {
    const HdfHandle space(size == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &size, nullptr), H5Sclose);
    const HdfHandle made(H5Acreate2(group, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    expect_done(H5Awrite(made, type, values));
  }

  HdfHandle file_;
  HdfHandle root_;
  HdfHandle steps_;
  std::map<std::string, GrowingArray> arrays_;
  std::array<std::int64_t, 4> cells_{};
  std::int64_t count_ = 0;
};

}  // namespace

void write_vtkhdf(const RunFrames& frames, const std::filesystem::path& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are thrown, not printed
  try {
    VtkHdfFile file(path);
    RunWalls walls;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      if (k == 0 || !frames.walls_stand()) walls = frames.walls(k);
      file.add(frames.read(k), walls, walls.are_lines());
    }
    file.finish();
  } catch (const InvalidMesh&) {
    throw;
  } catch (const Error& e) {
    throw Error(fmt::format("{}: the file cannot be written: {}", path.string(), e.what()));
  }
}

#else

void write_vtkhdf(const RunFrames& /*frames*/, const std::filesystem::path& path) {
  throw Error(fmt::format("{}: this dartcast was built without HDF5, which .vtkhdf needs (Debian: libhdf5-dev)",
                          path.string()));
}

#endif

}  // namespace dartcast
