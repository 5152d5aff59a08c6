"""Stand-ins with the names and shapes of other libraries' ray casters, over a moving mesh:
compat.trimesh.RayMeshIntersector and compat.open3d.RaycastingScene."""
