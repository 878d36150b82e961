/* The table of the node types of VRML97. Defaults stand where a field is used. */
#include "pipeline/scene/vrml_types.h"

#include <stdbool.h>
#include <string.h>

#include "base/compiler.h"

enum {
	SF_BOOL,
	SF_FLOAT,
	MF_FLOAT,
	SF_INT32,
	MF_INT32,
	SF_TIME,
	MF_TIME,
	SF_VEC2F,
	MF_VEC2F,
	SF_VEC3F,
	MF_VEC3F,
	SF_COLOR,
	MF_COLOR,
	SF_ROTATION,
	MF_ROTATION,
	SF_STRING,
	MF_STRING,
	SF_NODE,
	MF_NODE,
	SF_IMAGE,
};

static const struct vrml_type types[] = {
	[SF_BOOL] = { "SFBool", VRML_BOOLS, 1, 0 },
	[SF_FLOAT] = { "SFFloat", VRML_FLOATS, 1, 0 },
	[MF_FLOAT] = { "MFFloat", VRML_FLOATS, 1, 1 },
	[SF_INT32] = { "SFInt32", VRML_INTEGERS, 1, 0 },
	[MF_INT32] = { "MFInt32", VRML_INTEGERS, 1, 1 },
	[SF_TIME] = { "SFTime", VRML_FLOATS, 1, 0 },
	[MF_TIME] = { "MFTime", VRML_FLOATS, 1, 1 },
	[SF_VEC2F] = { "SFVec2f", VRML_FLOATS, 2, 0 },
	[MF_VEC2F] = { "MFVec2f", VRML_FLOATS, 2, 1 },
	[SF_VEC3F] = { "SFVec3f", VRML_FLOATS, 3, 0 },
	[MF_VEC3F] = { "MFVec3f", VRML_FLOATS, 3, 1 },
	[SF_COLOR] = { "SFColor", VRML_FLOATS, 3, 0 },
	[MF_COLOR] = { "MFColor", VRML_FLOATS, 3, 1 },
	[SF_ROTATION] = { "SFRotation", VRML_FLOATS, 4, 0 },
	[MF_ROTATION] = { "MFRotation", VRML_FLOATS, 4, 1 },
	[SF_STRING] = { "SFString", VRML_STRINGS, 1, 0 },
	[MF_STRING] = { "MFString", VRML_STRINGS, 1, 1 },
	[SF_NODE] = { "SFNode", VRML_NODES, 1, 0 },
	[MF_NODE] = { "MFNode", VRML_NODES, 1, 1 },
	[SF_IMAGE] = { "SFImage", VRML_IMAGE, 1, 0 },
};

#define F(name, type)                                                                              \
	{                                                                                          \
		name, &types[type]                                                                 \
	}

static const struct vrml_node_type nodes[] = {
	{ "Anchor",
	  { F("children", MF_NODE), F("description", SF_STRING), F("parameter", MF_STRING),
	    F("url", MF_STRING), F("bboxCenter", SF_VEC3F), F("bboxSize", SF_VEC3F) } },
	{ "Appearance",
	  { F("material", SF_NODE), F("texture", SF_NODE), F("textureTransform", SF_NODE) } },
	{ "AudioClip",
	  { F("description", SF_STRING), F("loop", SF_BOOL), F("pitch", SF_FLOAT),
	    F("startTime", SF_TIME), F("stopTime", SF_TIME), F("url", MF_STRING) } },
	{ "Background",
	  { F("groundAngle", MF_FLOAT), F("groundColor", MF_COLOR), F("backUrl", MF_STRING),
	    F("bottomUrl", MF_STRING), F("frontUrl", MF_STRING), F("leftUrl", MF_STRING),
	    F("rightUrl", MF_STRING), F("topUrl", MF_STRING), F("skyAngle", MF_FLOAT),
	    F("skyColor", MF_COLOR) } },
	{ "Billboard",
	  { F("axisOfRotation", SF_VEC3F), F("children", MF_NODE), F("bboxCenter", SF_VEC3F),
	    F("bboxSize", SF_VEC3F) } },
	{ "Box", { F("size", SF_VEC3F) } },
	{ "Collision",
	  { F("children", MF_NODE), F("collide", SF_BOOL), F("bboxCenter", SF_VEC3F),
	    F("bboxSize", SF_VEC3F), F("proxy", SF_NODE) } },
	{ "Color", { F("color", MF_COLOR) } },
	{ "ColorInterpolator", { F("key", MF_FLOAT), F("keyValue", MF_COLOR) } },
	{ "Cone",
	  { F("bottomRadius", SF_FLOAT), F("height", SF_FLOAT), F("side", SF_BOOL),
	    F("bottom", SF_BOOL) } },
	{ "Contour2D", { F("children", MF_NODE) } },
	{ "Coordinate", { F("point", MF_VEC3F) } },
	{ "CoordinateInterpolator", { F("key", MF_FLOAT), F("keyValue", MF_VEC3F) } },
	{ "Cylinder",
	  { F("bottom", SF_BOOL), F("height", SF_FLOAT), F("radius", SF_FLOAT), F("side", SF_BOOL),
	    F("top", SF_BOOL) } },
	{ "CylinderSensor",
	  { F("autoOffset", SF_BOOL), F("diskAngle", SF_FLOAT), F("enabled", SF_BOOL),
	    F("maxAngle", SF_FLOAT), F("minAngle", SF_FLOAT), F("offset", SF_FLOAT) } },
	{ "DirectionalLight",
	  { F("ambientIntensity", SF_FLOAT), F("color", SF_COLOR), F("direction", SF_VEC3F),
	    F("intensity", SF_FLOAT), F("on", SF_BOOL) } },
	{ "ElevationGrid",
	  { F("color", SF_NODE), F("normal", SF_NODE), F("texCoord", SF_NODE),
	    F("height", MF_FLOAT), F("ccw", SF_BOOL), F("colorPerVertex", SF_BOOL),
	    F("creaseAngle", SF_FLOAT), F("normalPerVertex", SF_BOOL), F("solid", SF_BOOL),
	    F("xDimension", SF_INT32), F("xSpacing", SF_FLOAT), F("zDimension", SF_INT32),
	    F("zSpacing", SF_FLOAT) } },
	{ "Extrusion",
	  { F("beginCap", SF_BOOL), F("ccw", SF_BOOL), F("convex", SF_BOOL),
	    F("creaseAngle", SF_FLOAT), F("crossSection", MF_VEC2F), F("endCap", SF_BOOL),
	    F("orientation", MF_ROTATION), F("scale", MF_VEC2F), F("solid", SF_BOOL),
	    F("spine", MF_VEC3F) } },
	{ "Fog",
	  { F("color", SF_COLOR), F("fogType", SF_STRING), F("visibilityRange", SF_FLOAT) } },
	{ "FontStyle",
	  { F("family", MF_STRING), F("horizontal", SF_BOOL), F("justify", MF_STRING),
	    F("language", SF_STRING), F("leftToRight", SF_BOOL), F("size", SF_FLOAT),
	    F("spacing", SF_FLOAT), F("style", SF_STRING), F("topToBottom", SF_BOOL) } },
	{ "Group", { F("children", MF_NODE), F("bboxCenter", SF_VEC3F), F("bboxSize", SF_VEC3F) } },
	{ "ImageTexture", { F("url", MF_STRING), F("repeatS", SF_BOOL), F("repeatT", SF_BOOL) } },
	{ "IndexedFaceSet",
	  { F("color", SF_NODE), F("coord", SF_NODE), F("normal", SF_NODE), F("texCoord", SF_NODE),
	    F("ccw", SF_BOOL), F("colorIndex", MF_INT32), F("colorPerVertex", SF_BOOL),
	    F("convex", SF_BOOL), F("coordIndex", MF_INT32), F("creaseAngle", SF_FLOAT),
	    F("normalIndex", MF_INT32), F("normalPerVertex", SF_BOOL), F("solid", SF_BOOL),
	    F("texCoordIndex", MF_INT32) } },
	{ "IndexedLineSet",
	  { F("color", SF_NODE), F("coord", SF_NODE), F("colorIndex", MF_INT32),
	    F("colorPerVertex", SF_BOOL), F("coordIndex", MF_INT32) } },
	{ "Inline", { F("url", MF_STRING), F("bboxCenter", SF_VEC3F), F("bboxSize", SF_VEC3F) } },
	{ "LOD", { F("level", MF_NODE), F("center", SF_VEC3F), F("range", MF_FLOAT) } },
	{ "Material",
	  { F("ambientIntensity", SF_FLOAT), F("diffuseColor", SF_COLOR),
	    F("emissiveColor", SF_COLOR), F("shininess", SF_FLOAT), F("specularColor", SF_COLOR),
	    F("transparency", SF_FLOAT) } },
	{ "MovieTexture",
	  { F("loop", SF_BOOL), F("speed", SF_FLOAT), F("startTime", SF_TIME),
	    F("stopTime", SF_TIME), F("url", MF_STRING), F("repeatS", SF_BOOL),
	    F("repeatT", SF_BOOL) } },
	{ "NavigationInfo",
	  { F("avatarSize", MF_FLOAT), F("headlight", SF_BOOL), F("speed", SF_FLOAT),
	    F("type", MF_STRING), F("visibilityLimit", SF_FLOAT) } },
	{ "Normal", { F("vector", MF_VEC3F) } },
	{ "NormalInterpolator", { F("key", MF_FLOAT), F("keyValue", MF_VEC3F) } },
	{ "NurbsCurve2D",
	  { F("controlPoint", MF_VEC2F), F("tessellation", SF_INT32), F("weight", MF_FLOAT),
	    F("knot", MF_FLOAT), F("order", SF_INT32) } },
	{ "NurbsGroup",
	  { F("children", MF_NODE), F("tessellationScale", SF_FLOAT), F("bboxCenter", SF_VEC3F),
	    F("bboxSize", SF_VEC3F) } },
	{ "NurbsSurface",
	  { F("controlPoint", MF_VEC3F), F("texCoord", SF_NODE), F("uTessellation", SF_INT32),
	    F("vTessellation", SF_INT32), F("weight", MF_FLOAT), F("ccw", SF_BOOL),
	    F("solid", SF_BOOL), F("uDimension", SF_INT32), F("uKnot", MF_FLOAT),
	    F("uOrder", SF_INT32), F("vDimension", SF_INT32), F("vKnot", MF_FLOAT),
	    F("vOrder", SF_INT32) } },
	{ "OrientationInterpolator", { F("key", MF_FLOAT), F("keyValue", MF_ROTATION) } },
	{ "PixelTexture", { F("image", SF_IMAGE), F("repeatS", SF_BOOL), F("repeatT", SF_BOOL) } },
	{ "PlaneSensor",
	  { F("autoOffset", SF_BOOL), F("enabled", SF_BOOL), F("maxPosition", SF_VEC2F),
	    F("minPosition", SF_VEC2F), F("offset", SF_VEC3F) } },
	{ "PointLight",
	  { F("ambientIntensity", SF_FLOAT), F("attenuation", SF_VEC3F), F("color", SF_COLOR),
	    F("intensity", SF_FLOAT), F("location", SF_VEC3F), F("on", SF_BOOL),
	    F("radius", SF_FLOAT) } },
	{ "PointSet", { F("color", SF_NODE), F("coord", SF_NODE) } },
	{ "Polyline2D", { F("point", MF_VEC2F) } },
	{ "PositionInterpolator", { F("key", MF_FLOAT), F("keyValue", MF_VEC3F) } },
	{ "ProximitySensor",
	  { F("center", SF_VEC3F), F("size", SF_VEC3F), F("enabled", SF_BOOL) } },
	{ "ScalarInterpolator", { F("key", MF_FLOAT), F("keyValue", MF_FLOAT) } },
	{ "Shape", { F("appearance", SF_NODE), F("geometry", SF_NODE) } },
	{ "Sound",
	  { F("direction", SF_VEC3F), F("intensity", SF_FLOAT), F("location", SF_VEC3F),
	    F("maxBack", SF_FLOAT), F("maxFront", SF_FLOAT), F("minBack", SF_FLOAT),
	    F("minFront", SF_FLOAT), F("priority", SF_FLOAT), F("source", SF_NODE),
	    F("spatialize", SF_BOOL) } },
	{ "Sphere", { F("radius", SF_FLOAT) } },
	{ "SphereSensor",
	  { F("autoOffset", SF_BOOL), F("enabled", SF_BOOL), F("offset", SF_ROTATION) } },
	{ "SpotLight",
	  { F("ambientIntensity", SF_FLOAT), F("attenuation", SF_VEC3F), F("beamWidth", SF_FLOAT),
	    F("color", SF_COLOR), F("cutOffAngle", SF_FLOAT), F("direction", SF_VEC3F),
	    F("intensity", SF_FLOAT), F("location", SF_VEC3F), F("on", SF_BOOL),
	    F("radius", SF_FLOAT) } },
	{ "Switch", { F("choice", MF_NODE), F("whichChoice", SF_INT32) } },
	{ "Text",
	  { F("string", MF_STRING), F("fontStyle", SF_NODE), F("length", MF_FLOAT),
	    F("maxExtent", SF_FLOAT) } },
	{ "TextureCoordinate", { F("point", MF_VEC2F) } },
	{ "TextureTransform",
	  { F("center", SF_VEC2F), F("rotation", SF_FLOAT), F("scale", SF_VEC2F),
	    F("translation", SF_VEC2F) } },
	{ "TimeSensor",
	  { F("cycleInterval", SF_TIME), F("enabled", SF_BOOL), F("loop", SF_BOOL),
	    F("startTime", SF_TIME), F("stopTime", SF_TIME) } },
	{ "TouchSensor", { F("enabled", SF_BOOL) } },
	{ "Transform",
	  { F("center", SF_VEC3F), F("children", MF_NODE), F("rotation", SF_ROTATION),
	    F("scale", SF_VEC3F), F("scaleOrientation", SF_ROTATION), F("translation", SF_VEC3F),
	    F("bboxCenter", SF_VEC3F), F("bboxSize", SF_VEC3F) } },
	{ "Viewpoint",
	  { F("fieldOfView", SF_FLOAT), F("jump", SF_BOOL), F("orientation", SF_ROTATION),
	    F("position", SF_VEC3F), F("description", SF_STRING) } },
	{ "TrimmedSurface", { F("trimmingContour", MF_NODE), F("surface", SF_NODE) } },
	{ "VisibilitySensor",
	  { F("center", SF_VEC3F), F("enabled", SF_BOOL), F("size", SF_VEC3F) } },
	{ "WorldInfo", { F("info", MF_STRING), F("title", SF_STRING) } },
};

#undef F

static bool same(const char *name, const char *text, size_t length)
{
	return strlen(name) == length && memcmp(name, text, length) == 0;
}

const struct vrml_type *vrml_type_named(const char *name, size_t length)
{
	for (size_t i = 0; i < ARRAY_COUNT(types); i++)
		if (same(types[i].name, name, length))
			return &types[i];
	return NULL;
}

const struct vrml_node_type *vrml_node_type_named(const char *name, size_t length)
{
	for (size_t i = 0; i < ARRAY_COUNT(nodes); i++)
		if (same(nodes[i].name, name, length))
			return &nodes[i];
	return NULL;
}

int vrml_field_named(const struct vrml_node_type *type, const char *name, size_t length)
{
	for (int i = 0; i < VRML_FIELDS_MAX && type->fields[i].name; i++)
		if (same(type->fields[i].name, name, length))
			return i;
	return -1;
}
