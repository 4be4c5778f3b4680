// A maze in the plane: rooms full of obstacles, joined by the doors of a random tree.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "base/random.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/ids.hpp"
#include "generators/generate_squares.hpp"

namespace dartcast {
namespace {

void check(const MazeOptions& o) {
  const auto refuse = [](const char* why) { throw InvalidArgument(fmt::format("maze: {}", why)); };
  if (o.rooms[0] == 0 || o.rooms[1] == 0) refuse("no rooms along an axis; give at least 1 along each");
  if (o.room_cells == 0) refuse("room_cells must be at least 1");
  if (o.door_cells == 0 || o.door_cells > o.room_cells) refuse("door_cells must be at least 1 and at most room_cells");
  if (o.obstacles >= std::uint64_t{o.room_cells} * o.room_cells)
    refuse("obstacles must be fewer than the squares of a room");
  if (!(o.extra_doors >= 0 && o.extra_doors <= 1)) refuse("extra_doors must be in [0, 1]");
  for (const std::uint32_t n : o.rooms) {
    if (n > Cell::index_mask / (std::uint64_t{o.room_cells} + 1)) refuse("too many squares along an axis");
  }
}

RectangleOptions squares_of(const MazeOptions& o) {
  RectangleOptions r;
  r.cells = {o.rooms[0] * (o.room_cells + 1) - 1, o.rooms[1] * (o.room_cells + 1) - 1};
  r.origin = o.origin;
  r.size = o.size;
  r.type = o.type;
  r.mixed = o.mixed;
  r.jitter = o.jitter;
  r.seed = o.seed;
  return r;
}

template <class T>
void shuffle(std::vector<T>& items, Random& random) {
  for (std::size_t n = items.size(); n > 1; --n)
    std::swap(items[n - 1], items[random.below(static_cast<std::uint32_t>(n))]);
}

// The marks of one maze's squares while it is built.
class MazeBuilder {
 public:
  MazeBuilder(const MazeOptions& options, const std::array<std::uint32_t, 2>& squares)
      : o_(options), nx_(squares[0]), ny_(squares[1]), pitch_(options.room_cells + 1) {}

  std::vector<std::uint8_t> build() {
    blocked_.reserve(std::size_t{nx_} * ny_);
    for (std::uint32_t j = 0; j < ny_; ++j) {
      for (std::uint32_t i = 0; i < nx_; ++i) blocked_.push_back(is_wall(i) || is_wall(j) ? 1 : 0);
    }
    open_doors();
    Random random(o_.seed, 6);
    for (std::uint32_t row = 0; row < o_.rooms[1]; ++row) {
      for (std::uint32_t column = 0; column < o_.rooms[0]; ++column) block_room(column, row, random);
    }
    return std::move(blocked_);
  }

 private:
  struct Square {
    std::uint32_t i, j;
  };

  // Between a room and the next one along an axis.
  struct Wall {
    std::uint32_t column, row;
    std::size_t axis;
  };

  [[nodiscard]] bool is_wall(std::uint32_t i) const { return i % pitch_ == o_.room_cells; }
  std::uint8_t& mark(const Square& s) { return blocked_[s.i + std::size_t{nx_} * s.j]; }

  // Kruskal's algorithm over the walls in random order: those between rooms not joined yet get a door.
  void open_doors() {
    Random random(o_.seed, 5);
    std::vector<Wall> walls;
    for (std::uint32_t row = 0; row < o_.rooms[1]; ++row) {
      for (std::uint32_t column = 0; column < o_.rooms[0]; ++column) {
        if (column + 1 < o_.rooms[0]) walls.push_back({column, row, 0});
        if (row + 1 < o_.rooms[1]) walls.push_back({column, row, 1});
      }
    }
    shuffle(walls, random);
    std::vector<std::size_t> parent(std::size_t{o_.rooms[0]} * o_.rooms[1]);
    std::iota(parent.begin(), parent.end(), std::size_t{0});
    const auto root = [&](std::size_t r) {
      while (parent[r] != r) r = parent[r] = parent[parent[r]];
      return r;
    };
    std::vector<Wall> closed;
    for (const Wall& w : walls) {
      const std::size_t room = w.column + std::size_t{o_.rooms[0]} * w.row;
      const std::size_t a = root(room), b = root(room + (w.axis == 0 ? 1 : o_.rooms[0]));
      if (a == b) {
        closed.push_back(w);
        continue;
      }
      parent[a] = b;
      open_door(w, random);
    }
    const auto extra = static_cast<std::size_t>(o_.extra_doors * static_cast<double>(closed.size()));
    for (std::size_t k = 0; k < extra; ++k) open_door(closed[k], random);
  }

  void open_door(const Wall& w, Random& random) {
    const std::uint32_t from = random.below(o_.room_cells - o_.door_cells + 1);
    for (std::uint32_t k = from; k < from + o_.door_cells; ++k) {
      const std::uint32_t i = w.column * pitch_, j = w.row * pitch_;
      mark(w.axis == 0 ? Square{i + o_.room_cells, j + k} : Square{i + k, j + o_.room_cells}) = 0;
    }
  }

  void block_room(std::uint32_t column, std::uint32_t row, Random& random) {
    std::vector<Square> squares;
    for (std::uint32_t j = row * pitch_; j < row * pitch_ + o_.room_cells; ++j) {
      for (std::uint32_t i = column * pitch_; i < column * pitch_ + o_.room_cells; ++i) squares.push_back({i, j});
    }
    shuffle(squares, random);
    std::uint32_t left = o_.obstacles;
    for (std::size_t k = 0; k < squares.size() && left > 0; ++k) {
      mark(squares[k]) = 1;
      if (is_connected(column, row)) {
        --left;
      } else {
        mark(squares[k]) = 0;
      }
    }
  }

  // Whether the free squares of a room and its doors are connected by their sides.
  bool is_connected(std::uint32_t column, std::uint32_t row) {
    const Square low = {column * pitch_ - (column > 0 ? 1 : 0), row * pitch_ - (row > 0 ? 1 : 0)};
    const Square high = {std::min(column * pitch_ + pitch_, nx_), std::min(row * pitch_ + pitch_, ny_)};
    const std::uint32_t width = high.i - low.i;
    std::vector<std::uint8_t> seen(std::size_t{width} * (high.j - low.j), 0);
    std::size_t free = 0, reached = 0;
    std::vector<Square> front;
    const auto visit = [&](std::uint32_t i, std::uint32_t j) {
      if (i < low.i || j < low.j || i >= high.i || j >= high.j || mark({i, j}) != 0) return;
      std::uint8_t& s = seen[(i - low.i) + std::size_t{width} * (j - low.j)];
      if (s == 0) front.push_back({i, j});
      s = 1;
    };
    for (std::uint32_t j = low.j; j < high.j; ++j) {
      for (std::uint32_t i = low.i; i < high.i; ++i) {
        if (mark({i, j}) != 0) continue;
        if (free++ == 0) visit(i, j);
      }
    }
    while (!front.empty()) {
      const Square s = front.back();
      front.pop_back();
      ++reached;
      visit(s.i + 1, s.j);
      visit(s.i, s.j + 1);
      visit(s.i - 1, s.j);  // 0 - 1 is large: outside
      visit(s.i, s.j - 1);
    }
    return reached == free;
  }

  const MazeOptions& o_;
  const std::uint32_t nx_, ny_, pitch_;
  std::vector<std::uint8_t> blocked_;
};

}  // namespace

MeshData generate_maze(const MazeOptions& options) {
  check(options);
  const RectangleOptions squares = squares_of(options);
  check_squares(squares, "maze");
  MeshData mesh = generate_squares(squares, MazeBuilder(options, squares.cells).build());
  std::fill(mesh.patch_tags.begin(), mesh.patch_tags.end(), 1);
  mesh.patch_names = {{1, "border"}};
  return mesh;
}

}  // namespace dartcast
