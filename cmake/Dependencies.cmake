# Everything that the lab uses, from the system's packages (`./lab setup` installs them on Debian 12).

find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(glm REQUIRED)
find_package(embree 3.13 REQUIRED)
find_package(assimp REQUIRED)
find_package(meshoptimizer REQUIRED)
set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE ON)  # solid meshes are small work in every build
find_package(CGAL REQUIRED)
find_package(Eigen3 3.3 REQUIRED CONFIG)  # for CGAL, whose own finder makes no target
find_package(TBB REQUIRED)
find_package(hwy REQUIRED)
find_package(CLI11 REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(PNG REQUIRED)
find_package(ZLIB REQUIRED)
find_package(benchmark REQUIRED)
pkg_check_modules(CAIRO REQUIRED IMPORTED_TARGET cairo)
pkg_check_modules(FREETYPE REQUIRED IMPORTED_TARGET freetype2)
pkg_check_modules(OSMESA REQUIRED IMPORTED_TARGET osmesa)
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
# The letters of pictures.
find_file(VISLAB_FONT DejaVuSans.ttf PATHS /usr/share/fonts/truetype/dejavu REQUIRED)
find_file(VISLAB_FONT_BOLD DejaVuSans-Bold.ttf PATHS /usr/share/fonts/truetype/dejavu REQUIRED)

# What others built, to compare with (algorithms/peers). Not needed: what is missing is left out.
find_path(VISLAB_FILAMENT_INCLUDE filament/Frustum.h PATH_SUFFIXES filament-1.9)
find_library(VISLAB_FILAMENT_LIBRARY filament)
if(VISLAB_FILAMENT_INCLUDE AND VISLAB_FILAMENT_LIBRARY)
  # Its culler is in the library, but in none of the headers: other versions may have another.
  include(CheckCXXSourceCompiles)
  set(CMAKE_REQUIRED_INCLUDES "${VISLAB_FILAMENT_INCLUDE}")
  set(CMAKE_REQUIRED_LIBRARIES "${VISLAB_FILAMENT_LIBRARY}")
  set(CMAKE_REQUIRED_FLAGS "-std=c++20")
  check_cxx_source_compiles("
    #include <filament/Frustum.h>
    #include <math/vec3.h>
    namespace filament {
    struct Culler {
      static void intersects(unsigned char*, const Frustum&, const math::float3*,
                             const math::float3*, unsigned long, unsigned long);
    };
    }
    int main() {
      filament::Culler::intersects(nullptr, filament::Frustum(), nullptr, nullptr, 0, 0);
    }" VISLAB_HAS_FILAMENT)
  unset(CMAKE_REQUIRED_INCLUDES)
  unset(CMAKE_REQUIRED_LIBRARIES)
  unset(CMAKE_REQUIRED_FLAGS)
endif()
if(VISLAB_HAS_FILAMENT)
  add_library(vislab_filament_library INTERFACE)
  target_include_directories(vislab_filament_library SYSTEM INTERFACE "${VISLAB_FILAMENT_INCLUDE}")
  target_link_libraries(vislab_filament_library INTERFACE "${VISLAB_FILAMENT_LIBRARY}")
else()
  message(STATUS "peer.filament is left out: there is no libfilament-dev 1.9")
endif()
find_path(VISLAB_BULLET_INCLUDE BulletCollision/BroadphaseCollision/btDbvt.h PATH_SUFFIXES bullet)
find_library(VISLAB_BULLET_COLLISION BulletCollision)
find_library(VISLAB_BULLET_MATH LinearMath)
if(VISLAB_BULLET_INCLUDE AND VISLAB_BULLET_COLLISION AND VISLAB_BULLET_MATH)
  set(VISLAB_HAS_BULLET TRUE)
  add_library(vislab_bullet_library INTERFACE)
  target_include_directories(vislab_bullet_library SYSTEM INTERFACE "${VISLAB_BULLET_INCLUDE}")
  target_link_libraries(vislab_bullet_library INTERFACE "${VISLAB_BULLET_COLLISION}" "${VISLAB_BULLET_MATH}")
else()
  message(STATUS "peer.bullet is left out: there is no libbullet-dev")
endif()

if(VISLAB_TESTS)
  find_package(GTest REQUIRED)
  include(GoogleTest)
endif()
