kdray_test(scene_mesh
  SOURCES ply_test.cpp stl_test.cpp obj_test.cpp mtl_test.cpp gltf_test.cpp gltf_material_test.cpp assimp_test.cpp
          mutations_test.cpp odd_files_test.cpp smooth_normals_test.cpp stitches_test.cpp real_meshes_test.cpp paint_test.cpp picture_test.cpp instances_test.cpp
          ../support/stitched_meshes.cpp
  LIBS kdray::scene kdray::film nlohmann_json::nlohmann_json PNG::PNG
  LABELS unit
  APART gltf_test.cpp gltf_material_test.cpp mtl_test.cpp obj_test.cpp stl_test.cpp)
if(turbojpeg_FOUND)
  target_link_libraries(scene_mesh_test PRIVATE PkgConfig::turbojpeg)
  target_compile_definitions(scene_mesh_test PRIVATE KDRAY_WITH_JPEG=1)
endif()
