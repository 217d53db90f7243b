"""Right: print only, in Spanish, with a usage text and a retry limit of its own."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts

USO = 'Uso: python3 suma.py <entero> <entero> <entero>'


def pedir(nodo, cliente, x, y):
    peticion = AddTwoInts.Request()
    peticion.a = x
    peticion.b = y
    futuro = cliente.call_async(peticion)
    rclpy.spin_until_future_complete(nodo, futuro, timeout_sec=10.0)
    return futuro.result().sum


def main():
    try:
        numeros = [int(palabra) for palabra in sys.argv[1:]]
        a, b, c = numeros
    except ValueError:
        print(USO)
        return
    rclpy.init()
    nodo = rclpy.create_node('sumadora')
    cliente = nodo.create_client(AddTwoInts, 'add_two_ints')
    intentos = 5
    while not cliente.wait_for_service(timeout_sec=1.0):
        intentos -= 1
        print(f'⏳ el servicio no está, quedan {intentos} intentos')
        if intentos == 0:
            print('❌ me rindo: not available')
            return
    print('✅ La suma es', pedir(nodo, cliente, pedir(nodo, cliente, a, b), c))


if __name__ == '__main__':
    main()
