"""Right: a loop of spin_once, print instead of the logger, tabs, Spanish."""
import rclpy
from rclpy.node import Node
from my_robot_interfaces.srv import AddTwoInts


class Sumador(Node):
	def __init__(self):
		super().__init__('sumador')
		self.atendidas = 0
		self.servicio = self.create_service(AddTwoInts, 'add_two_ints', self.atender)

	def atender(self, peticion, respuesta):
		self.atendidas += 1
		respuesta.sum = peticion.a + peticion.b
		print('petición n.º', self.atendidas, '→', respuesta.sum)
		return respuesta


rclpy.init()
nodo = Sumador()
while rclpy.ok():
	rclpy.spin_once(nodo, timeout_sec=0.1)
