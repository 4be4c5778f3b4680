// Binds dartcast/scene.hpp and dartcast/scene_file.hpp: scenes as plain records, and their files.
#include "dartcast/scene.hpp"

#include <string>
#include <utility>

#include "bind.hpp"
#include "dartcast/scene_file.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::scene {
namespace {

void bind_environment_scene(py::module_& m) {
  Record<FreeRegions>(m, "FreeRegions").field("regions", &FreeRegions::regions).finish();
  Record<FreeValues>(m, "FreeValues").field("array", &FreeValues::array).field("values", &FreeValues::values).finish();
  Record<PatchArray>(m, "PatchArray").field("name", &PatchArray::name).finish();
  Record<PatchAngle>(m, "PatchAngle").field("degrees", &PatchAngle::degrees).finish();
  bind_enum<Mesher>(m, "Mesher", {{"ANY", Mesher::any}, {"TETGEN", Mesher::tetgen}, {"GMSH", Mesher::gmsh}});
  Record<NamedSurface>(m, "NamedSurface")
      .field("region", &NamedSurface::region)
      .field("file", &NamedSurface::file)
      .finish();
  Record<SurfaceScene>(m, "SurfaceScene")
      .field("surfaces", &SurfaceScene::surfaces)
      .field("outside", &SurfaceScene::outside)
      .field("box", &SurfaceScene::box)
      .field("size", &SurfaceScene::size)
      .field("cap", &SurfaceScene::cap)
      .field("angle", &SurfaceScene::angle)
      .field("mesher", &SurfaceScene::mesher)
      .field("seconds", &SurfaceScene::seconds)
      .finish();
  m.def(
      "mesh_surfaces",
      [](const SurfaceScene& surfaces, const ReadOptions& options) {
        const SurfaceScene own = surfaces;
        const ReadOptions own_options = options;
        const py::gil_scoped_release release;
        return mesh_surfaces(own, own_options);
      },
      py::arg("scene"), py::arg("options") = ReadOptions{}, doc("mesh_surfaces"));
  Record<EnvironmentScene>(m, "EnvironmentScene")
      .field("mesh", &EnvironmentScene::mesh)
      .field("scale", &EnvironmentScene::scale)
      .field("linearise", &EnvironmentScene::linearise)
      .field("skip_bad_cells", &EnvironmentScene::skip_bad_cells)
      .field("free", &EnvironmentScene::free)
      .field("patches", &EnvironmentScene::patches)
      .finish();
  Record<DeformationScene>(m, "DeformationScene")
      .field("step", &DeformationScene::step)
      .field("field", &DeformationScene::field)
      .field("path", &DeformationScene::path)
      .field("frames", &DeformationScene::frames)
      .field("spacing", &DeformationScene::spacing)
      .finish();
}

void bind_particles_scene(py::module_& m) {
  Record<RandomParticles>(m, "RandomParticles").field("count", &RandomParticles::count).finish();
  Record<ParticleSeeds>(m, "ParticleSeeds")
      .field("name", &ParticleSeeds::name)
      .field("points", &ParticleSeeds::points)
      .field("velocities", &ParticleSeeds::velocities)
      .field("radii", &ParticleSeeds::radii)
      .finish();
  Record<PlacedParticles>(m, "PlacedParticles").field("positions", &PlacedParticles::positions).finish();
  Record<InletParticles>(m, "InletParticles")
      .field("patch", &InletParticles::patch)
      .field("rate", &InletParticles::rate)
      .finish();
  Record<ParticlesScene>(m, "ParticlesScene")
      .field("source", &ParticlesScene::source)
      .field("velocity", &ParticlesScene::velocity)
      .field("radius", &ParticlesScene::radius)
      .field("user_data", &ParticlesScene::user_data)
      .finish();
}

void bind_solid_scenes(py::module_& m) {
  bind_enum<BodySamples>(
      m, "BodySamples",
      {{"SOLID", BodySamples::solid}, {"SURFACE", BodySamples::surface}, {"VOLUME", BodySamples::volume}});
  Record<BodyScene>(m, "BodyScene")
      .field("name", &BodyScene::name)
      .field("surface", &BodyScene::surface)
      .field("scale", &BodyScene::scale)
      .field("rotate", &BodyScene::rotate)
      .field("at", &BodyScene::at)
      .field("samples", &BodyScene::samples)
      .field("sampling", &BodyScene::sampling)
      .field("cluster", &BodyScene::cluster)
      .field("edges", &BodyScene::edges)
      .field("body", &BodyScene::body)
      .finish();
  Record<CatheterScene> catheter(m, "CatheterScene");
  catheter.field("name", &CatheterScene::name)
      .field("options", &CatheterScene::options)
      .field("moves", &CatheterScene::moves)
      .field("camera", &CatheterScene::camera);
  Record<CatheterScene::Move>(catheter.finish(), "Move", "CatheterScene::Move")
      .field("until", &CatheterScene::Move::until)
      .field("push", &CatheterScene::Move::push)
      .field("turn", &CatheterScene::Move::turn)
      .finish();
  Record<SolidScene> solid(m, "SolidScene");
  solid.field("name", &SolidScene::name)
      .field("shape", &SolidScene::shape)
      .field("scale", &SolidScene::scale)
      .field("rotate", &SolidScene::rotate)
      .field("at", &SolidScene::at)
      .field("pivot", &SolidScene::pivot)
      .field("moves", &SolidScene::moves)
      .field("catch_up", &SolidScene::catch_up);
  Record<SolidScene::Move>(solid.finish(), "Move", "SolidScene::Move")
      .field("until", &SolidScene::Move::until)
      .field("velocity", &SolidScene::Move::velocity)
      .field("turn", &SolidScene::Move::turn)
      .finish();
}

void bind_motion(py::module_& m) {
  Record<FieldScene>(m, "FieldScene")
      .field("array", &FieldScene::array)
      .field("at", &FieldScene::at)
      .field("frame", &FieldScene::frame)
      .field("files", &FieldScene::files)
      .field("times", &FieldScene::times)
      .field("spacing", &FieldScene::spacing)
      .field("period", &FieldScene::period)
      .field("interpolation", &FieldScene::interpolation)
      .field("samples", &FieldScene::samples)
      .def_property_readonly("given", &FieldScene::given, doc("FieldScene::given"))
      .finish();
  Record<MotionScene>(m, "MotionScene")
      .field("dt", &MotionScene::dt)
      .field("steps", &MotionScene::steps)
      .field("gravity", &MotionScene::gravity)
      .field("field", &MotionScene::field)
      .field("force", &MotionScene::force)
      .field("drag", &MotionScene::drag)
      .field("substeps", &MotionScene::substeps)
      .field("integrator", &MotionScene::integrator)
      .field("wall_motion", &MotionScene::wall_motion)
      .finish();
  Record<ContactScene>(m, "ContactScene")
      .field("general", &ContactScene::general)
      .field("by_patch", &ContactScene::by_patch)
      .finish();
}

void bind_changes(py::module_& m) {
  Record<EventScene>(m, "EventScene")
      .field("event", &EventScene::event)
      .field("patch", &EventScene::patch)
      .field("region", &EventScene::region)
      .finish();
  Record<RemeshScene>(m, "RemeshScene")
      .field("every", &RemeshScene::every)
      .field("options", &RemeshScene::options)
      .finish();
  Record<AdaptiveSubdivisionScene>(m, "AdaptiveSubdivisionScene")
      .field("every", &AdaptiveSubdivisionScene::every)
      .field("options", &AdaptiveSubdivisionScene::options)
      .finish();
  bind_enum<Compression>(m, "Compression",
                         {{"NONE", Compression::none}, {"FAST", Compression::fast}, {"SMALL", Compression::small}});
  Record<OutputScene>(m, "OutputScene")
      .field("every", &OutputScene::every)
      .field("contacts", &OutputScene::contacts)
      .field("report", &OutputScene::report)
      .field("compression", &OutputScene::compression)
      .finish();
}

void bind_whole(py::module_& m) {
  Record<StatisticsScene>(m, "StatisticsScene")
      .field("options", &StatisticsScene::options)
      .field("crossings", &StatisticsScene::crossings)
      .finish();
  Record<Scene>(m, "Scene")
      .field("name", &Scene::name)
      .field("file", &Scene::file)
      .field("text", &Scene::text)
      .field("seed", &Scene::seed)
      .field("environment", &Scene::environment)
      .field("deformation", &Scene::deformation)
      .field("particles", &Scene::particles)
      .field("user_data", &Scene::user_data)
      .field("collisions", &Scene::collisions)
      .field("body_collisions", &Scene::body_collisions)
      .field("bodies", &Scene::bodies)
      .field("catheters", &Scene::catheters)
      .field("solids", &Scene::solids)
      .field("motion", &Scene::motion)
      .field("contact", &Scene::contact)
      .field("events", &Scene::events)
      .field("remesh", &Scene::remesh)
      .field("adaptive_subdivision", &Scene::adaptive_subdivision)
      .field("statistics", &Scene::statistics)
      .field("output", &Scene::output)
      .finish();
}

void bind_files(py::module_& m) {
  m.def("read_scene", &read_scene, py::arg("path"), doc("read_scene"));
  m.def("parse_scene", &parse_scene, py::arg("text"), py::arg("path"), doc("parse_scene"));
  Record<LoadedScene>(m, "LoadedScene")
      .field("scene", &LoadedScene::scene)
      .field("skipped", &LoadedScene::skipped)
      .field("warnings", &LoadedScene::warnings)
      .finish();
  m.def(
      "load_scene_files",
      [](const Scene& scene, const ReadOptions& options, Threads threads) {
        Scene copy = scene;
        const ReadOptions own_options = options;
        const py::gil_scoped_release release;
        return load_scene_files(std::move(copy), own_options, threads);
      },
      py::arg("scene"), py::arg("options") = ReadOptions{}, py::arg("threads") = Threads{}, doc("load_scene_files"));
}

}  // namespace

void bind(py::module_& m) {
  m.attr("MAX_SEED") = max_seed;
  m.attr("MAX_STEPS") = max_steps;
  bind_environment_scene(m);
  bind_particles_scene(m);
  bind_solid_scenes(m);
  bind_motion(m);
  bind_changes(m);
  bind_whole(m);
  bind_files(m);
}

}  // namespace dartcast::python::scene
