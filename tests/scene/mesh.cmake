kdray_test(scene_mesh
  SOURCES ply_test.cpp stl_test.cpp obj_test.cpp mtl_test.cpp gltf_test.cpp gltf_material_test.cpp assimp_test.cpp
          mutations_test.cpp odd_files_test.cpp smooth_normals_test.cpp zero_area_test.cpp real_meshes_test.cpp textures_test.cpp maps_test.cpp picture_test.cpp sky_test.cpp
          gltf_packed_test.cpp gltf_animation_test.cpp webp_picture_test.cpp instances_test.cpp names_test.cpp tangents_test.cpp
          ../support/zero_area_meshes.cpp
  LIBS kdray::scene kdray::image nlohmann_json::nlohmann_json PNG::PNG
  LABELS unit
  APART tangents_test.cpp webp_picture_test.cpp gltf_animation_test.cpp gltf_packed_test.cpp gltf_test.cpp gltf_material_test.cpp maps_test.cpp mtl_test.cpp obj_test.cpp sky_test.cpp stl_test.cpp)
if(turbojpeg_FOUND)
  target_link_libraries(scene_mesh_test PRIVATE PkgConfig::turbojpeg)
  target_compile_definitions(scene_mesh_test PRIVATE KDRAY_WITH_JPEG=1)
endif()
# What packs the samples that are to be unpacked.
if(draco_FOUND)
  target_link_libraries(scene_mesh_test PRIVATE draco::draco)
  target_compile_definitions(scene_mesh_test PRIVATE KDRAY_WITH_DRACO=1)
endif()
if(meshoptimizer_FOUND)
  target_link_libraries(scene_mesh_test PRIVATE meshoptimizer::meshoptimizer)
  target_compile_definitions(scene_mesh_test PRIVATE KDRAY_WITH_MESHOPT=1)
endif()
if(webp_FOUND)
  target_link_libraries(scene_mesh_test PRIVATE PkgConfig::webp)
  target_compile_definitions(scene_mesh_test PRIVATE KDRAY_WITH_WEBP=1)
endif()
