"""The fuzz targets: functions of bytes, for atheris, the property tests and the stored corpus."""
