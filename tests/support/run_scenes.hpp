// The texts of short scenes that have everything that a run can have.
#pragma once

#include <string>

namespace dartcast::test {

// All that a state can hold: particles injected, stuck, absorbed and gone, moving vertices, polylines.
inline const std::string scene_text = R"(
seed = 5
[environment]
generator = "box"
cells = [5, 5, 5]
blocked_share = 0.1
[[deformation]]
kind = "twist"
amplitude = 0.4
length = 5.0
period = 0.7
[[particles]]
count = 200
velocity = [3.0, 1.0, 0.5]
[[particles]]
inlet = "xmin"
rate = 170.0
velocity = [4.0, 0.5, 0.0]
[motion]
dt = 0.02
steps = 47
substeps = 2
gravity = [0.0, 0.0, -5.0]
[contact.patch.xmax]
response = "escape"
[contact.patch.zmin]
response = "stick"
[contact.patch.ymax]
response = "absorb"
[output]
every = 10
contacts = true
)";

// Every kind of event, and cells that turn over and are remeshed.
inline const std::string surgery_text = R"(
[environment]
generator = "box"
cells = [12, 6, 6]
blocked_layer = true
[[deformation]]
kind = "bump"
amplitude = 2.0
period = 1.0
axis = [0.0, 0.0, 1.0]
centre = [3.0, 3.0, 3.0]
length = 2.0
[[particles]]
count = 300
velocity = [1.0, 0.25, -0.5]
[motion]
dt = 0.02
steps = 47
gravity = [0.0, 0.0, -5.0]
[contact]
restitution = 0.5
[[event]]
at = 0.1
kind = "cut"
surface = "disc"
point = [6.0, 3.0, 0.5]
normal = [1.0, 0.0, 0.0]
radius = 1.5
width = 0.5
[[event]]
at = 0.3
kind = "carve"
tool = "box"
low = [9.0, -1.0, -1.0]
high = [10.0, 7.0, 7.0]
what = "remove"
stranded = "absorb"
[[event]]
at = 0.3
kind = "ligature"
point = [7.5, 3.0, 3.0]
normal = [1.0, 0.0, 0.0]
draw = 0.5
reach = 1.0
duration = 0.2
stranded = "stay"
[[event]]
at = 0.6
kind = "reconnect"
a = { point = [9.0, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }
b = { point = [10.0, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }
within = 0.01
patch = "xmin"
[remesh]
every = 1
[output]
every = 10
)";

// Bodies and a catheter among the particles, in a scene that bends and is carved.
inline const std::string solids_text = R"(
[environment]
generator = "box"
cells = [6, 6, 6]
size = [0.6, 0.6, 0.6]
[[deformation]]
kind = "twist"
amplitude = 0.3
length = 0.6
period = 1.0
[[particles]]
count = 50
[[body]]
name = "barrel"
generator = "barrel"
radius = 0.05
bulge = 0.01
height = 0.12
spacing = 0.025
at = [0.2, 0.2, 0.15]
velocity = [0.5, 0.4, -2.0]
[[body]]
generator = "barrel"
radius = 0.04
bulge = 0.0
height = 0.1
spacing = 0.03
at = [0.45, 0.45, 0.4]
rotate = [0.5, 0.0, 0.0]
cluster = 0.06
[[catheter]]
entry = [0.05, 0.3, 0.3]
direction = [1.0, 0.0, 0.0]
length = 0.4
spacing = 0.01
tip_length = 0.05
tip_curvature = 8.0
camera = 0.01
moves = [{ until = 0.3, push = 0.5 }, { until = 0.4, turn = 2.0 }, { until = 1.0, push = 0.2, turn = -1.0 }]
[motion]
dt = 0.01
steps = 47
gravity = [0.0, 0.0, -9.81]
[contact]
restitution = 0.4
friction = 0.2
[[event]]
at = 0.22
kind = "carve"
tool = "box"
low = [0.41, -0.1, 0.41]
high = [0.7, 0.7, 0.7]
what = "remove"
[output]
every = 10
)";

// Spheres that pile up; crowded cells are subdivided, and made again when they have left.
inline const std::string spheres_text = R"(
[environment]
generator = "box"
cells = [3, 3, 3]
size = [0.3, 0.3, 0.3]
[[deformation]]
kind = "swing"
amplitude = 1.2
period = 1.0
axis = [0.0, 1.0, 0.0]
centre = [0.15, 0.15, 0.15]
[[particles]]
count = 200
radius = 0.008
[[particles]]
inlet = "zmax"
rate = 50.0
radius = 0.004
velocity = [0.0, 0.0, -0.5]
[motion]
dt = 0.01
steps = 47
gravity = [0.0, 0.0, -9.81]
[contact]
restitution = 0.2
friction = 0.3
[collisions]
restitution = 0.2
friction = 0.3
[adaptive_subdivision]
every = 5
most = 15
least = 6
smallest = 0.02
[output]
every = 10
)";

// A tool that a wall stops, and that stops a wall.
inline const std::string tools_text = R"(
[environment]
generator = "box"
cells = [4, 4, 4]
size = [4.0, 4.0, 4.0]
[[deformation]]
kind = "bump"
amplitude = 0.6
period = 0.4
axis = [0.0, 0.0, 1.0]
centre = [2.0, 2.0, 0.0]
length = 1.5
[[particles]]
count = 50
velocity = [1.0, 0.5, -0.7]
[[solid]]
points = [[1.5, 2.0, 0.4], [2.0, 2.2, 0.3], [2.5, 2.0, 0.4]]
[[solid]]
name = "needle"
points = [[0.5, 0.5, 1.0], [0.5, 0.5, 2.0]]
catch_up = true
moves = [{ until = 0.3, velocity = [0.0, 0.0, 10.0], turn = [0.1, 0.2, 0.0] }, { until = 0.5, velocity = [0.0, 0.0, -10.0] }]
[motion]
dt = 0.01
steps = 47
[output]
every = 10
contacts = true
)";

// A tool, a catheter and a body, all of which stop walls.
inline const std::string edges_text = R"(
[environment]
generator = "box"
cells = [4, 4, 4]
size = [4.0, 4.0, 4.0]
[[deformation]]
kind = "bump"
amplitude = 0.9
period = 0.4
axis = [0.0, 0.0, 1.0]
centre = [2.0, 2.0, 0.0]
length = 1.5
[[particles]]
count = 50
velocity = [1.0, 0.5, -0.7]
[[solid]]
points = [[0.5, 3.0, 0.3], [3.0, 3.2, 0.2]]
[[catheter]]
entry = [0.3, 2.0, 0.4]
direction = [1.0, 0.0, 0.0]
length = 3.0
spacing = 0.5
stiffness = 0.05
moves = [{ until = 0.2, push = 12.0 }]
[[body]]
generator = "barrel"
radius = 0.4
bulge = 0.1
height = 0.8
staves = 8
spacing = 0.25
at = [2.6, 1.2, 0.9]
[contact]
restitution = 0.5
[motion]
dt = 0.01
steps = 47
gravity = [0.0, 0.0, -9.81]
[output]
every = 10
contacts = true
)";

// A plug flow of 2 m/s: 100 particles per second, and one that stands still.
inline const std::string plug_flow_text = R"(
[environment]
generator = "box"
cells = [8, 2, 2]
[[particles]]
inlet = "xmin"
rate = 100.0
velocity = [2.0, 0.0, 0.0]
[motion]
dt = 0.01
steps = 655
[contact.patch.xmax]
response = "escape"
[statistics]
hits = true
residence = true
crossings = true
pathlines = { every = 100, ids = [5, 6] }
cells = { quantities = ["track_length", "residence", "visits", "deposition", "concentration"] }
[[statistics.plane]]
name = "middle"
point = [4.0, 0.0, 0.0]
normal = [1.0, 0.0, 0.0]
[[statistics.plane]]
name = "axis"
point = [2.0, 1.0, 1.0]
normal = [-1.0, 0.0, 0.0]
radius = 0.5
[output]
every = 100
)";

// Particles that are injected, absorbed and cut free in a mesh that deforms and is edited.
inline const std::string statistics_text = R"(
[environment]
generator = "box"
cells = [8, 5, 5]
blocked_layer = true
[[deformation]]
kind = "twist"
amplitude = 0.3
axis = [1.0, 0.0, 0.0]
centre = [4.0, 2.5, 2.5]
length = 8.0
period = 0.7
[[particles]]
count = 300
velocity = [3.0, 0.5, -0.5]
[motion]
dt = 0.02
steps = 47
substeps = 2
gravity = [0.0, 0.0, -5.0]
[[event]]
at = 0.3
kind = "cut"
surface = "disc"
point = [4.0, 2.5, 0.5]
normal = [1.0, 0.0, 0.0]
radius = 1.5
width = 0.5
[[event]]
at = 0.6
kind = "carve"
tool = "box"
low = [5.0, -1.0, -1.0]
high = [6.0, 6.0, 6.0]
what = "remove"
stranded = "absorb"
[adaptive_subdivision]
every = 5
most = 15
least = 6
[statistics]
hits = true
residence = true
crossings = true
pathlines = { every = 10 }
cells = { quantities = ["track_length", "residence", "visits", "deposition", "concentration"] }
[[statistics.plane]]
name = "middle"
point = [4.0, 2.5, 2.5]
normal = [1.0, 0.3, 0.0]
[output]
every = 10
)";

}  // namespace dartcast::test
