"""Drops that run on the skin of an animated object of Blender: blender -b FILE.blend -P blender.py.

Blender has surfaces, so this is dartcast's Surface. Where there is no bpy a stand-in takes its place.
"""
import numpy as np

import dartcast as dc

try:
    import bpy
except ImportError:
    from stand_ins import bpy


def points_of(object_):
    """The points of the object at the scene's frame, with all its modifiers; its corners, too."""
    evaluated = object_.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    flat = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", flat)
    corners = [list(polygon.vertices) for polygon in mesh.polygons]
    evaluated.to_mesh_clear()
    return flat.reshape(-1, 3).astype(float), corners


skin, scene = bpy.data.objects["Skin"], bpy.context.scene
scene.frame_set(1)
points, corners = points_of(skin)
surface = dc.topology.Surface(dc.MeshData(points, {"polygon": corners}))
starts = np.random.default_rng(1).uniform([1.0, 1.0, 0.0], [3.0, 3.0, 0.0], (200, 3))
places, _ = dc.topology.SurfaceLocator(surface).nearest(surface, starts)
velocities, dt, left = np.tile([0.5, 0.2, 0.0], (len(places), 1)), 1 / 24, 0

for frame in range(2, 50):
    scene.frame_set(frame)                                       # 1. the animation's step
    surface.move(points_of(skin)[0])                             # 2. its points are the surface's
    velocities += [0.0, 0.0, -9.81 * dt]                         # 3. the drops fall, as far as the skin lets them
    report = dc.advance(surface, places, velocities * dt)
    velocities = report.steps["direction"] * report.steps["length"][:, None] / dt
    left += len(report.contacts)                                 # 4. drops at the border of the skin

x = surface.point(places)
print(f"{len(x)} drops from z = {x[:, 2].min():.2f} to {x[:, 2].max():.2f}, {left} contacts with the border")
