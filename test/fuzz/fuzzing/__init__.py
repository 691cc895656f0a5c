"""What is fuzzed: functions of bytes, for atheris, for the property tests and for the stored corpus alike."""
