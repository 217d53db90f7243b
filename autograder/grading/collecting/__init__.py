"""Takes students' notebooks from the download of a learning management system (LMS) into ``submitted``."""
