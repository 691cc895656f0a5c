"""The Python package `roah_rsbb`, for catkin (which reads this file, and installs with it)."""

from setuptools import find_packages, setup

setup(
    name="roah_rsbb",
    version="0.1.0",
    description="RoAH RSBB: the Referee, Scoring and Benchmarking Box of a home-robot competition",
    license="BSD-3-Clause",
    packages=find_packages("src"),
    package_dir={"": "src"},
    python_requires=">=3.8",
)
