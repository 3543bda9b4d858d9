kdray_test(scene_text
  SOURCES read_file_test.cpp text_scanner_test.cpp plain_number_test.cpp reserve_ahead_test.cpp material_table_test.cpp
          nff_test.cpp json_test.cpp
          json_schema_test.cpp triangulate_test.cpp geometry_test.cpp frame_test.cpp studio_test.cpp load_test.cpp
  LIBS kdray::scene nlohmann_json::nlohmann_json ZLIB::ZLIB LibLZMA::LibLZMA
  LABELS unit)
