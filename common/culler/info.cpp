#include "common/culler/culler.h"

namespace vislab {

std::string_view to_string(Guarantee value) {
  switch (value) {
    case Guarantee::conservative:
      return "conservative";
    case Guarantee::image_exact:
      return "image_exact";
    case Guarantee::approximate:
      return "approximate";
    case Guarantee::erroneous:
      return "erroneous";
  }
  return "";
}

std::string_view to_string(Repeatability value) {
  switch (value) {
    case Repeatability::stateless:
      return "stateless";
    case Repeatability::path:
      return "path";
    case Repeatability::timing:
      return "timing";
  }
  return "";
}

std::string_view to_string(Granularity value) {
  switch (value) {
    case Granularity::object:
      return "object";
    case Granularity::triangle:
      return "triangle";
  }
  return "";
}

std::string_view to_string(Culls value) {
  switch (value) {
    case Culls::back_faces:
      return "back_faces";
    case Culls::outside_frustum:
      return "outside_frustum";
    case Culls::hidden:
      return "hidden";
  }
  return "";
}

std::string_view to_string(Space value) {
  switch (value) {
    case Space::object:
      return "object";
    case Space::image:
      return "image";
  }
  return "";
}

std::string_view to_string(PipelineStage value) {
  switch (value) {
    case PipelineStage::application:
      return "application";
    case PipelineStage::geometry:
      return "geometry";
    case PipelineStage::raster:
      return "raster";
  }
  return "";
}

}  // namespace vislab
